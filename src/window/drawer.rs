//! The drawer at the bottom: times over time, memory, device, messages, files to keep, a benchmark.

use egui::{Grid, ScrollArea, Ui};

use super::interface::Interface;
use super::layout::Tab;
use super::protocol::Request;
use super::{bench_tab, keep_tab, times_tab};

/// The drawer with its tabs.
pub fn show(ui: &mut Ui, face: &mut Interface) {
    // A drawer is as high as its user has made it, whatever it holds.
    ui.set_min_height(ui.available_height());
    ui.horizontal(|ui| {
        let messages = face.session.validation.len() + face.session.warnings.len();
        let messages = if messages > 0 { format!("Messages ({messages})") } else { "Messages".to_owned() };
        let tabs = [
            (Tab::Times, "Times"),
            (Tab::Memory, "Memory"),
            (Tab::Device, "Device"),
            (Tab::Messages, messages.as_str()),
            (Tab::Keep, "Keep"),
            (Tab::Bench, "Bench"),
        ];
        for (tab, name) in tabs {
            if ui.selectable_label(face.layout.tab == tab, name).clicked() {
                face.layout.tab = tab;
                if tab == Tab::Memory {
                    face.ask(Request::Memory);
                }
            }
        }
    });
    match face.layout.tab {
        Tab::Times => times_tab::show(ui, face),
        Tab::Memory => show_memory(ui, face),
        Tab::Device => show_device(ui, face),
        Tab::Messages => show_messages(ui, face),
        Tab::Keep => keep_tab::show(ui, face),
        Tab::Bench => bench_tab::show(ui, face),
    }
}

/// Bytes in the unit that reads best.
fn bytes(bytes: u64) -> String {
    const MIB: f64 = 1024.0 * 1024.0;
    match bytes as f64 {
        small if small < MIB => format!("{:.1} KiB", small / 1024.0),
        middle if middle < 1024.0 * MIB => format!("{:.1} MiB", middle / MIB),
        large => format!("{:.2} GiB", large / MIB / 1024.0),
    }
}

fn show_memory(ui: &mut Ui, face: &mut Interface) {
    let mut is_asked = false;
    let Some(memory) = &face.session.memory else {
        ui.weak("Memory is known when the paper is built.");
        return;
    };
    ui.horizontal_wrapped(|ui| {
        ui.label(format!(
            "{} in {} resources, at most {}; the device's heap has {}",
            bytes(memory.total_bytes),
            memory.resources.len(),
            bytes(memory.peak_bytes),
            bytes(memory.heap_bytes)
        ));
        if let Some(process) = memory.process_bytes {
            ui.label(format!("the process that draws holds {}", bytes(process)));
        }
        is_asked = ui.small_button("Ask again").clicked();
    });
    let mut resources = memory.resources.clone();
    resources.sort_by_key(|resource| std::cmp::Reverse(resource.bytes));
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        Grid::new("memory").striped(true).show(ui, |ui| {
            for resource in &resources {
                ui.label(&resource.name);
                ui.monospace(format!("{:>12}", bytes(resource.bytes)));
                let fraction = resource.bytes as f32 / memory.total_bytes.max(1) as f32;
                ui.add(egui::ProgressBar::new(fraction).desired_width(160.0).desired_height(8.0));
                ui.weak(if resource.is_host_visible { "host visible" } else { "" });
                ui.end_row();
            }
        });
    });
    if is_asked {
        face.ask(Request::Memory);
    }
}

fn show_device(ui: &mut Ui, face: &mut Interface) {
    let Some(ready) = face.session.ready.clone() else { return };
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.label(&ready.device);
        match face.session.limits {
            None => {
                if ui
                    .button("Measure its limits")
                    .on_hover_text("Copy, arithmetic, fill and blend rates; seconds")
                    .clicked()
                {
                    face.ask(Request::Limits);
                }
            }
            Some(limits) => {
                let rates = [
                    ("copies", limits.copy_gb_s, "GB/s"),
                    ("fused multiply-adds", limits.fma_gflops, "GFLOP/s"),
                    ("fill", limits.fill_gpix_s, "Gpix/s"),
                    ("blending", limits.blend_gpix_s, "Gpix/s"),
                ];
                for (name, rate, unit) in rates {
                    if let Some(rate) = rate {
                        ui.label(format!("{name}: {rate:.2} {unit}"));
                    }
                }
            }
        }
        if let Some(folder) = &ready.shader_dir {
            ui.horizontal(|ui| {
                ui.label(format!("Shaders are compiled from {folder} when saved."));
                if ui.small_button("Reload").clicked() {
                    face.ask(Request::Reload);
                }
            });
        }
        for side in face.session.built.iter().flat_map(|built| &built.sides) {
            if let (Some(build), Some(load)) = (side.build_ms, side.load_ms) {
                ui.weak(format!("loaded in {load:.0} ms, built in {build:.0} ms"));
            }
        }
    });
}

fn show_messages(ui: &mut Ui, face: &mut Interface) {
    ScrollArea::vertical().auto_shrink(false).stick_to_bottom(true).show(ui, |ui| {
        let session = &face.session;
        for warning in &session.warnings {
            ui.label(warning);
        }
        for message in &session.validation {
            ui.colored_label(ui.visuals().error_fg_color, message);
        }
        if session.warnings.is_empty() && session.validation.is_empty() {
            let validates = session.ready.as_ref().is_some_and(|ready| ready.validates);
            ui.weak(if validates {
                "The validation layer is silent."
            } else {
                "Nothing to say; --validate turns the validation layer on."
            });
        }
    });
}
