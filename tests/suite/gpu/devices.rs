//! The choice of a device, on the devices of this machine.

use std::sync::Arc;

use ash::vk;
use fumarole::gpu::live::Kind;
use fumarole::gpu::physical::choose;
use fumarole::gpu::{Device, Error, Feature, Instance, PhysicalDevice};

use crate::common::{gpu_test, gpu_test_alone};

fn enumerate(instance: &Arc<Instance>) -> Vec<PhysicalDevice> {
    PhysicalDevice::enumerate(instance).unwrap()
}

/// A part of the name that one device alone has, in the other case.
fn telling_part(devices: &[PhysicalDevice], one: &PhysicalDevice) -> Option<String> {
    let part: String = one.name.chars().skip(1).collect();
    let part = part.to_uppercase();
    (devices.iter().filter(|d| d.name.to_uppercase().contains(&part)).count() == 1).then_some(part)
}

#[test]
fn every_device_is_found_by_index_name_and_uuid() {
    gpu_test(|device| {
        let instance = device.instance();
        let devices = enumerate(instance);
        for one in &devices {
            let mut words = vec![one.index.to_string(), one.uuid_text(), one.uuid_text().to_uppercase()];
            words.push(one.uuid_text().replace('-', ""));
            words.extend(telling_part(&devices, one));
            if !one.lacks(&[]).is_empty() {
                continue;
            }
            for word in words {
                let found = choose(enumerate(instance), Some(&word), &[]).unwrap();
                assert_eq!((found.index, found.uuid), (one.index, one.uuid), "{word}");
            }
        }
        let name = &device.physical().name;
        assert!(telling_part(&devices, device.physical()).is_some(), "{name} is not the only one of its name");
    });
}

#[test]
fn a_device_that_is_not_there_is_named_beside_those_that_are() {
    gpu_test(|device| {
        let devices = enumerate(device.instance());
        for wanted in [&devices.len().to_string(), "no such device", "", "  ", "00000000-0000-0000-0000-00000000000f"] {
            let error = choose(enumerate(device.instance()), Some(wanted), &[]).map(|d| d.name).unwrap_err();
            assert!(matches!(error, Error::UnknownDevice { .. }), "{wanted:?}: {error}");
            let message = error.to_string();
            assert!(message.contains(&format!("{wanted:?}")), "{message}");
            assert!(devices.iter().all(|d| message.contains(&d.name) && message.contains(&d.uuid_text())), "{message}");
        }
    });
}

#[test]
fn a_name_that_several_devices_share_is_ambiguous() {
    gpu_test(|device| {
        let mut twice = enumerate(device.instance());
        twice.extend(enumerate(device.instance()));
        let error = choose(twice, Some(&device.physical().name), &[]).map(|d| d.name).unwrap_err();
        assert!(matches!(error, Error::AmbiguousDevice { .. }), "{error}");
        assert!(error.to_string().contains(&device.physical().uuid_text()), "{error}");
    });
}

#[test]
fn without_a_wish_the_best_capable_kind_is_taken() {
    gpu_test(|device| {
        let devices = enumerate(device.instance());
        let best = devices.iter().filter(|d| d.lacks(&[]).is_empty()).map(|d| d.device_type).min().unwrap();
        let chosen = choose(devices, None, &[]).unwrap();
        assert_eq!(chosen.device_type, best);
        let error = choose(Vec::new(), None, &[]).map(|d| d.name).unwrap_err();
        assert!(matches!(error, Error::NoDevice { .. }), "{error}");
    });
}

#[test]
fn what_a_device_lacks_is_named() {
    gpu_test(|device| {
        let mut old = enumerate(device.instance());
        let name = device.physical().name.clone();
        for one in &mut old {
            one.api_version = vk::API_VERSION_1_2;
        }
        let error = choose(old, Some(&name), &[Feature::GeometryShader]).map(|d| d.name).unwrap_err();
        assert!(matches!(error, Error::MissingFeature { .. }), "{error}");
        let message = error.to_string();
        assert!(message.contains(&name) && message.contains("Vulkan 1.3"), "{message}");

        let mut queueless = enumerate(device.instance());
        for one in &mut queueless {
            one.queue = None;
        }
        let error = choose(queueless, None, &[]).map(|d| d.name).unwrap_err();
        assert!(matches!(error, Error::NoDevice { .. }), "{error}");
        assert!(error.to_string().contains("a queue with graphics and compute"), "{error}");
    });
}

#[test]
fn an_instance_and_its_device_leave_nothing_behind() {
    gpu_test_alone(|shared| {
        let instance = Instance::new(true).unwrap();
        let live = instance.live().clone();
        let physical = choose(enumerate(&instance), Some(&shared.physical().uuid_text()), &[]).unwrap();
        let device = Device::open(&instance, physical).unwrap();
        assert_eq!(live.alive(), [(Kind::Instance, 1), (Kind::Device, 1)]);
        drop(instance);
        assert_eq!(live.alive(), [(Kind::Instance, 1), (Kind::Device, 1)], "the device keeps its instance");
        device.wait_idle().unwrap();
        assert!(device.instance().validates());
        assert_eq!(device.instance().layers(), ["VK_LAYER_KHRONOS_validation"]);
        device.instance().check_messages().unwrap();
        drop(device);
        assert_eq!(live.alive(), []);
    });
}
