//! What the GPU can do to a frame: a lost device, no memory, a call that validation refuses.

mod common;

use common::Site;
use umbrage_lab::gpu::{AdapterChoice, Gpu, GpuError};
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::stage::Casters;

const SIZE: [u32; 2] = [96, 64];

fn lab() -> Lab {
    Lab::new(Gpu::open(&AdapterChoice::Auto).expect("these tests need an adapter"))
}

fn is_lost<T>(done: Result<T, GpuError>) -> bool {
    matches!(done, Err(GpuError::DeviceLost(_)))
}

#[test]
fn a_lost_device_is_an_error_wherever_it_is_noticed() {
    let site = Site::open("gen:city?triangles=2000&lights=8", Casters::Material);
    let view = site.first_camera(SIZE);
    for method in Method::ALL {
        let mut lab = lab();
        lab.prepare(&site.stage, &site.lights, &view, method);
        let mut kept = lab.masking(&site.stage, &view).expect("a renderer");
        lab.mask_in(&mut kept, &site.stage, &site.lights, &view)
            .expect("the device is there");
        lab.gpu().device.destroy();
        let kept = lab.mask_in(&mut kept, &site.stage, &site.lights, &view);
        assert!(is_lost(kept), "{}", method.name());
        let new = lab.mask(&site.stage, &site.lights, &view);
        assert!(is_lost(new), "{}", method.name());
        let lit = lab.render(&site.stage, &site.lights, &view, method, 1);
        assert!(is_lost(lit), "{}", method.name());
    }
}

/// Within a frame, too: after upload and before the picture is read.
#[test]
fn a_device_lost_between_frames_is_an_error() {
    let site = Site::open("gen:city?triangles=2000&lights=8", Casters::Material);
    let view = site.first_camera(SIZE);
    let mut lab = lab();
    let device = lab.gpu().device.clone();
    let lit = lab.render_while(&site.stage, &site.lights, &view, Method::Counter, |_| {
        device.destroy();
        true
    });
    assert!(is_lost(lit));
}

/// The negative control of every other test: what validation refuses is no silence.
#[test]
fn a_bad_call_is_fatal() {
    let lab = lab();
    let bad = std::panic::AssertUnwindSafe(|| {
        lab.gpu().device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("mapped and stored at once"),
            size: 16,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        })
    });
    assert!(std::panic::catch_unwind(bad).is_err());
}
