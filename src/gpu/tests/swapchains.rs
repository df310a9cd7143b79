//! Swapchains of windows on a display of the tests' own: taking over, refusals, failed waits, and threads at one window.

use std::ffi::CString;
use std::io::{BufRead, BufReader};
use std::num::NonZeroU32;
use std::process::{Child, Command, Stdio};
use std::ptr::NonNull;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use ash::vk;
use raw_window_handle::{
    DisplayHandle, HandleError, HasDisplayHandle, HasWindowHandle, RawDisplayHandle, RawWindowHandle, WindowHandle,
    XcbDisplayHandle, XcbWindowHandle,
};
use x11rb::COPY_DEPTH_FROM_PARENT;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConfigureWindowAux, ConnectionExt, CreateWindowAux, WindowClass};
use x11rb::xcb_ffi::XCBConnection;

use super::super::surface::{Display, Surface};
use super::super::swapchain::{PresentMode, Presented, Swapchain};
use super::super::{
    Blend, Compiler, Device, Error, Image, ImageDesc, ImageView, Instance, Load, Mode, Pass, PhysicalDevice, Recorder,
    ShaderLibrary,
};
use super::{Kind, alone, choose, fail, failing, open_device};

/// An X server without a screen, and a connection to it.
struct Server {
    process: Child,
    connection: XCBConnection,
    screen: usize,
}

impl Server {
    /// # Panics
    /// Xvfb is not installed: a test never passes for want of it.
    fn start() -> Arc<Self> {
        let mut command = Command::new("Xvfb");
        // It ends with its last client, so with this process, however that ends.
        command.args(["-displayfd", "1", "-terminate", "-screen", "0", "200x200x24", "-nolisten", "tcp"]);
        let process = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let mut process = process.expect("Xvfb is missing: run ./setup.sh --tests");
        let mut number = String::new();
        BufReader::new(process.stdout.take().unwrap()).read_line(&mut number).unwrap();
        let name = CString::new(format!(":{}", number.trim())).unwrap();
        let (connection, screen) = XCBConnection::connect(Some(&name)).unwrap();
        Arc::new(Server { process, connection, screen })
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // The connection is of no more use then; nothing else waits for the process.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A window of 8 x 8 pixels, at first.
struct Window {
    server: Arc<Server>,
    id: u32,
}

impl Window {
    fn open(server: &Arc<Server>) -> Arc<Self> {
        let connection = &server.connection;
        let id = connection.generate_id().unwrap();
        let root = connection.setup().roots[server.screen].root;
        let (class, more) = (WindowClass::INPUT_OUTPUT, CreateWindowAux::new());
        let made = connection.create_window(COPY_DEPTH_FROM_PARENT, id, root, 0, 0, 8, 8, 0, class, 0, &more);
        made.unwrap().check().unwrap();
        connection.map_window(id).unwrap().check().unwrap();
        Arc::new(Window { server: server.clone(), id })
    }

    fn resize(&self, (width, height): (u32, u32)) {
        let size = ConfigureWindowAux::new().width(width).height(height);
        self.server.connection.configure_window(self.id, &size).unwrap().check().unwrap();
    }
}

impl HasDisplayHandle for Window {
    fn display_handle(&self) -> Result<DisplayHandle<'_>, HandleError> {
        let connection = NonNull::new(self.server.connection.get_raw_xcb_connection());
        let handle = XcbDisplayHandle::new(connection, self.server.screen as i32);
        // SAFETY: the connection is open as long as the window's server.
        Ok(unsafe { DisplayHandle::borrow_raw(RawDisplayHandle::Xcb(handle)) })
    }
}

impl HasWindowHandle for Window {
    fn window_handle(&self) -> Result<WindowHandle<'_>, HandleError> {
        let handle = XcbWindowHandle::new(NonZeroU32::new(self.id).ok_or(HandleError::Unavailable)?);
        // SAFETY: nobody destroys the window before its connection ends.
        Ok(unsafe { WindowHandle::borrow_raw(RawWindowHandle::Xcb(handle)) })
    }
}

/// A device of this test's own, under validation, that presents to the window, whose surface it is given with.
fn open_presenting(window: &Arc<Window>) -> (Arc<Device>, Arc<Surface>) {
    let instance = Instance::for_display(true, &Display::of(window).unwrap()).unwrap();
    let surface = Surface::new(&instance, window).unwrap();
    let wanted = std::env::var("FUMAROLE_TEST_DEVICE").unwrap_or_else(|_| "llvmpipe".to_owned());
    let physical = choose(surface.devices().unwrap(), Some(&wanted), &[]).unwrap();
    (Device::open_presenting(&instance, physical).unwrap(), surface)
}

fn assert_valid(device: &Device) {
    let messages: Vec<String> = device.instance().take_messages().iter().map(ToString::to_string).collect();
    assert!(messages.is_empty(), "{messages:#?}");
}

/// Runs `body` on a device that presents to the window; nothing is left of it then, and the validation layer has said
/// nothing.
fn presenting(body: impl FnOnce(&Arc<Device>, &Arc<Surface>, &Arc<Window>)) {
    let _alone = alone();
    let window = Window::open(&Server::start());
    let (device, surface) = open_presenting(&window);
    body(&device, &surface, &window);
    drop(surface);
    assert_eq!(device.live().alive(), [(Kind::Instance, 1), (Kind::Device, 1)]);
    assert_valid(&device);
}

fn swapchain(device: &Arc<Device>, surface: &Arc<Surface>, old: Option<Swapchain>) -> Result<Swapchain, Error> {
    Swapchain::new(device, surface, (8, 8), PresentMode::Fifo, old).map(|made| made.unwrap())
}

/// Presents the picture once the display has an image to spare.
fn show(swapchain: &mut Swapchain, picture: &Arc<ImageView>) {
    for _ in 0..100 {
        match swapchain.present(picture).unwrap() {
            Presented::Busy => {}
            other => return assert_eq!(other, Presented::Shown),
        }
    }
    panic!("the display has no image to spare");
}

/// A picture that was drawn, of so many pixels.
fn picture(device: &Arc<Device>, format: vk::Format, (width, height): (u32, u32)) -> Arc<ImageView> {
    let desc = ImageDesc::new_2d("picture", format, width, height).usage(vk::ImageUsageFlags::COLOR_ATTACHMENT);
    let view = Image::new(device, desc).unwrap().view().unwrap();
    let clear = Pass::graphics("clear", "", "test/asymmetric.vert", "test/asymmetric.frag")
        .color(&view, Load::Clear([0.5; 4]), Blend::Replace)
        .build(&ShaderLibrary::new(device, Compiler::Glslang, None).unwrap())
        .unwrap();
    Recorder::new(device).unwrap().run(Mode::Plain, |frame| frame.graphics(&clear, |_| {})).unwrap();
    view
}

fn message<T>(outcome: Result<T, Error>) -> String {
    outcome.map(|_| ()).unwrap_err().to_string()
}

#[test]
fn a_swapchain_takes_over_from_the_one_before() {
    presenting(|device, surface, window| {
        let mut old = None;
        for size in [(16, 8), (8, 8), (8, 8), (32, 16)] {
            window.resize(size);
            let mut made = swapchain(device, surface, old).unwrap();
            assert_eq!(device.live().count(Kind::Swapchain), 1);
            assert_eq!(made.extent(), size);
            let picture = picture(device, made.picture_format(), size);
            (0..5).for_each(|_| show(&mut made, &picture));
            old = Some(made);
        }
    });
}

#[test]
fn a_surface_has_another_form_when_its_window_has_another_size() {
    presenting(|device, surface, window| {
        let made = swapchain(device, surface, None).unwrap();
        let first = made.surface_form().unwrap();
        assert_eq!(made.surface_form().unwrap(), first);
        window.resize((16, 8));
        assert_ne!(made.surface_form().unwrap(), first);
        window.resize((8, 8));
        assert_eq!(made.surface_form().unwrap(), first);
    });
}

#[test]
fn a_device_presents_by_an_instance_with_surfaces() {
    presenting(|device, _, window| {
        let plain = open_device();
        let found = PhysicalDevice::enumerate(plain.instance()).unwrap();
        let same = choose(found, Some(&plain.physical().uuid_text()), &[]).unwrap();
        let refused = message(Device::open_presenting(plain.instance(), same));
        assert!(refused.contains("presenting: its instance was not made for a display"), "{refused}");
        let refused = message(Surface::new(plain.instance(), window));
        assert!(refused.contains("the instance was not made for this kind of display"), "{refused}");
        let other = Instance::for_display(false, &Display::of(window).unwrap()).unwrap();
        let surface = Surface::new(&other, window).unwrap();
        let refused = message(swapchain(device, &surface, None));
        assert!(refused.contains("the surface belongs to another device"), "{refused}");
        assert_valid(&plain);
    });
}

#[test]
fn a_surface_has_one_swapchain_at_a_time() {
    presenting(|device, surface, window| {
        let second = "the window: neither this layer nor this device has a second swapchain at a time";
        let first = swapchain(device, surface, None).unwrap();
        assert!(message(swapchain(device, surface, None)).starts_with(second));
        drop(first);
        let first = swapchain(device, surface, None).unwrap();
        // One of another surface is no old one of this: it goes, and its surface is free.
        let other = Surface::new(device.instance(), &Window::open(&window.server)).unwrap();
        let moved = swapchain(device, &other, Some(first)).unwrap();
        let first = swapchain(device, surface, None).unwrap();
        assert_eq!(device.live().count(Kind::Swapchain), 2);
        assert!(message(swapchain(device, surface, Some(moved))).starts_with(second));
        assert_eq!(device.live().count(Kind::Swapchain), 1);
        swapchain(device, surface, Some(first)).unwrap();
        swapchain(device, &other, None).unwrap();
    });
}

#[test]
fn threads_want_one_surface() {
    presenting(|device, surface, _| {
        let made: usize = thread::scope(|scope| {
            let want = || (0..10).filter(|_| swapchain(device, surface, None).is_ok()).count();
            let threads = [(); 3].map(|()| scope.spawn(want));
            threads.map(|thread| thread.join().unwrap()).into_iter().sum()
        });
        assert!(made > 0);
    });
}

#[test]
fn pictures_fit_their_swapchain() {
    presenting(|device, surface, _| {
        let mut made = swapchain(device, surface, None).unwrap();
        let format = made.picture_format();
        let fitting = picture(device, format, (8, 8));
        let number = picture(device, vk::Format::R32_SFLOAT, (8, 8));
        assert_eq!(message(made.present(&number)), "pass present: picture is not of the swapchain's format");
        let undrawn = ImageDesc::new_2d("undrawn", format, 8, 8).usage(vk::ImageUsageFlags::SAMPLED);
        let layers = Image::new(device, undrawn.clone().layers(2)).unwrap().view().unwrap();
        assert_eq!(message(made.present(&layers)), "pass present: undrawn has 2 layers; give one");
        let undrawn = Image::new(device, undrawn).unwrap().view().unwrap();
        assert_eq!(message(made.present(&undrawn)), "pass present: reads undrawn, which no pass has written");
        let mut kept = ImageDesc::new_2d("kept", format, 8, 8);
        kept.usage = vk::ImageUsageFlags::COLOR_ATTACHMENT;
        let kept = Image::new(device, kept).unwrap().view().unwrap();
        assert_eq!(message(made.present(&kept)), "pass present: kept was not made to be copied so");
        assert_eq!(made.present(&picture(device, format, (8, 4))).unwrap(), Presented::Stale);
        // None of them has cost an image.
        (0..8).for_each(|_| show(&mut made, &fitting));
        drop(made);
        let plain = open_device();
        let refused = message(swapchain(&plain, surface, None));
        assert!(refused.contains("presenting: the device was opened without it"), "{refused}");
    });
}

#[test]
fn after_a_failed_wait_a_swapchain_stays_with_its_surface() {
    let _alone = alone();
    let window = Window::open(&Server::start());
    let (device, surface) = open_presenting(&window);
    let device = failing(device);
    let mut made = swapchain(&device, &surface, None).unwrap();
    let fitting = picture(&device, made.picture_format(), (8, 8));
    // The wait for the copy fails, and the device turns out to be idle: an image was acquired and not shown.
    fail(1, 0);
    assert!(message(made.present(&fitting)).contains("waiting for"));
    assert_eq!(made.present(&fitting).unwrap(), Presented::Stale);
    let mut made = swapchain(&device, &surface, Some(made)).unwrap();
    show(&mut made, &fitting);
    // Nobody knows that it is idle, at the present or at either drop: that of the swapchain, that of its commands.
    fail(1, 3);
    assert!(made.present(&fitting).is_err());
    drop((made, surface));
    let count = |kind| device.live().count(kind);
    assert_eq!([Kind::Swapchain, Kind::Surface, Kind::CommandPool].map(count), [1; 3]);
    assert_valid(&device);
}

#[test]
fn a_swapchain_whose_presents_do_not_end_stays_with_its_surface() {
    let _alone = alone();
    let window = Window::open(&Server::start());
    let (device, surface) = open_presenting(&window);
    let mut made = swapchain(&device, &surface, None).unwrap();
    made.hold().unwrap();
    let count = |kind| device.live().count(kind);
    let images = count(Kind::Fence) - 1;
    assert!(images > 2, "{images}");
    let started = Instant::now();
    drop((made, surface));
    // One second for all images together, and not for each; clocks may differ a little.
    let for_each = Duration::from_secs(images as u64) - Duration::from_millis(100);
    assert!(started.elapsed() < for_each, "{:?} for {images} images", started.elapsed());
    let left = [Kind::Swapchain, Kind::Surface, Kind::CommandPool, Kind::Fence, Kind::Semaphore].map(count);
    assert_eq!(left, [1, 1, 0, images, images + 1]);
    assert_valid(&device);
}
