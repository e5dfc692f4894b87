//! Adapter and device: the one place where the lab touches the machine.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use thiserror::Error;
use umbrage_truth::NearClip;
use umbrage_wgpu::{RenderError, check_storage};

/// Which adapter to use.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum AdapterChoice {
    /// The fastest: discrete, integrated, virtual, then software.
    #[default]
    Auto,
    /// The first whose name contains this, ignoring case.
    Name(String),
    /// A software rasteriser.
    Cpu,
}

/// What can go wrong between the lab and the GPU.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No adapter fits the choice.
    #[error(
        "no usable GPU adapter{}: {}",
        if found.is_empty() { "" } else { " among those found" },
        remedy(choice, found)
    )]
    NoAdapter {
        /// What was asked for.
        choice: AdapterChoice,
        /// Names of the adapters there are.
        found: Vec<String>,
    },
    /// The adapter refused to give a device.
    #[error("adapter {adapter} gave no device: {message}")]
    NoDevice {
        /// Its name.
        adapter: String,
        /// Its words.
        message: String,
    },
    /// A texture would pass a device limit.
    #[error("a {width}x{height} picture is beyond this device's limit of {limit} pixels a side")]
    SizeTooLarge {
        /// Asked width.
        width: u32,
        /// Asked height.
        height: u32,
        /// Device limit.
        limit: u32,
    },
    /// The device has no memory left.
    #[error("no GPU memory for {what} of {bytes} bytes: choose a smaller one, or free some")]
    NoMemory {
        /// What was to be made.
        what: &'static str,
        /// Its size.
        bytes: u64,
    },
    /// The device ran out of memory somewhere in a frame.
    #[error(
        "the GPU ran out of memory ({0}): choose a smaller --size, fewer lights or a smaller \
         scene, or close what else uses it"
    )]
    OutOfMemory(String),
    /// A heat map of volumes for a method that has none.
    #[error("{method} draws no volumes, so there is no such heat map of it; lights works")]
    NoVolumes {
        /// Its name.
        method: String,
    },
    /// An array of textures would pass a device limit.
    #[error("{lights} lights are more than the {limit} that a mask on this device can hold")]
    TooManyLights {
        /// Lights of the scene.
        lights: usize,
        /// What fits.
        limit: usize,
    },
    /// No thread to work on.
    #[error("a thread could not be started: {0}")]
    Threads(String),
    /// Reading results back failed.
    #[error("a frame could not be read back: {0}")]
    Readback(String),
    /// A world that f32 cannot hold, and a method that has no more.
    #[error(
        "{method} works with f32 positions, which cannot hold this world: \
         choose a method that counts volumes, or an --origin near the scene"
    )]
    NeedsF32 {
        /// Its name.
        method: String,
    },
    /// The device is gone: unplugged, reset by the system, or hung.
    #[error(
        "the GPU device was lost ({0}): start again; if it happens again, choose a smaller size, \
         fewer lights, or another --adapter"
    )]
    DeviceLost(String),
    /// The method makes no mask that could be applied so.
    #[error(transparent)]
    NoMask(#[from] crate::application::NoMask),
    /// The library refused.
    #[error(transparent)]
    Render(#[from] RenderError),
}

fn remedy(choice: &AdapterChoice, found: &[String]) -> String {
    match choice {
        AdapterChoice::Name(name) => {
            format!("none is called {name:?}; there are: {}", found.join(", "))
        }
        _ if cfg!(target_os = "linux") => "install a Vulkan driver, in software if there is no \
            GPU: apt-get install libvulkan1 mesa-vulkan-drivers (Debian, Ubuntu), dnf install \
            mesa-vulkan-drivers (Fedora), pacman -S vulkan-swrast (Arch)"
            .into(),
        _ => "update the graphics driver".into(),
    }
}

/// A device with what it can do; clones are the same device.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Name of the adapter, and its driver in brackets.
    pub adapter: String,
    /// Its driver.
    pub driver: String,
    /// Whether z-pass is safe (`DEPTH_CLIP_CONTROL`).
    pub depth_clamp: bool,
    /// Why the device was lost, once it was.
    lost: Arc<OnceLock<String>>,
    /// The first allocation that failed since that was last told.
    exhausted: Arc<Mutex<Option<String>>>,
    /// Nanoseconds per timestamp tick, where there are timestamps.
    pub timestamp_ns: Option<f32>,
}

impl Gpu {
    /// Whether a storage buffer of so many bytes can be made and bound.
    pub(crate) fn check_storage(
        &self,
        what: &'static str,
        bytes: usize,
    ) -> Result<(), RenderError> {
        check_storage(&self.device, what, bytes as u64).map(|_| ())
    }

    /// A buffer with something in it. Unlike wgpu's own way, which maps it, this takes a lost device
    /// in silence: what is drawn then is never read.
    pub(crate) fn create_buffer_init(
        &self,
        init: &wgpu::util::BufferInitDescriptor<'_>,
    ) -> wgpu::Buffer {
        let alignment = wgpu::COPY_BUFFER_ALIGNMENT as usize;
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: init.label,
            size: init
                .contents
                .len()
                .next_multiple_of(alignment)
                .max(alignment) as u64,
            usage: init.usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, init.contents);
        buffer
    }

    /// The error, or that the device was lost or out of memory if that explains it.
    pub(crate) fn lost_or(&self, error: GpuError) -> GpuError {
        self.trouble().unwrap_or(error)
    }

    /// Whether the device is still there, and had memory for all that was made since this was last
    /// asked. What was made without is void: drawing with it does nothing, and is never read.
    pub(crate) fn check_alive(&self) -> Result<(), GpuError> {
        // It is told no earlier. What a poll has to say in words, the reason says too.
        let _ = self.device.poll(wgpu::PollType::Poll);
        self.trouble().map_or(Ok(()), Err)
    }

    fn trouble(&self) -> Option<GpuError> {
        if let Some(why) = self.lost.get() {
            return Some(GpuError::DeviceLost(why.clone()));
        }
        let mut exhausted = self
            .exhausted
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        exhausted.take().map(GpuError::OutOfMemory)
    }

    /// Whether any buffer of so many bytes can be made.
    pub(crate) fn check_buffer(&self, what: &'static str, needed: u64) -> Result<(), RenderError> {
        let limit = self.device.limits().max_buffer_size;
        if needed > limit {
            return Err(RenderError::BufferTooLarge {
                what,
                needed,
                limit_name: "max_buffer_size",
                limit,
            });
        }
        Ok(())
    }

    /// What happens to surfaces before the near plane.
    pub fn near_clip(&self) -> NearClip {
        match self.depth_clamp {
            true => NearClip::Clamped,
            false => NearClip::Clipped,
        }
    }

    /// Finds an adapter and opens a device with the limits the adapter has. Errors that
    /// validation reports later are fatal: the lab must never cause one.
    pub fn open(choice: &AdapterChoice) -> Result<Self, GpuError> {
        Self::open_limited(choice, |_| ())
    }

    /// As [`Gpu::open`], among the adapters of `instance` that can present to `surface`; with what
    /// that surface takes.
    pub fn open_for(
        instance: &wgpu::Instance,
        surface: &wgpu::Surface<'_>,
        choice: &AdapterChoice,
    ) -> Result<(Self, wgpu::SurfaceCapabilities), GpuError> {
        let adapter = adapter(instance, Some(surface), choice)?;
        let capabilities = surface.get_capabilities(&adapter);
        Ok((Self::of(&adapter, |_| ())?, capabilities))
    }

    /// As [`Gpu::open`], with limits that `lower` may lower: what a smaller device would do.
    pub fn open_limited(
        choice: &AdapterChoice,
        lower: impl FnOnce(&mut wgpu::Limits),
    ) -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::PRIMARY,
            // The driver's own validation where it is installed and this is a debug build.
            flags: wgpu::InstanceFlags::from_build_config(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        Self::of(&adapter(&instance, None, choice)?, lower)
    }

    fn of(
        adapter: &wgpu::Adapter,
        lower: impl FnOnce(&mut wgpu::Limits),
    ) -> Result<Self, GpuError> {
        let info = adapter.get_info();
        let wanted = wgpu::Features::DEPTH_CLIP_CONTROL
            | wgpu::Features::DEPTH32FLOAT_STENCIL8
            | wgpu::Features::INDIRECT_FIRST_INSTANCE
            | wgpu::Features::TIMESTAMP_QUERY;
        let features = adapter.features() & wanted;
        let mut limits = adapter.limits();
        lower(&mut limits);
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("umbrage lab"),
            required_features: features,
            required_limits: limits,
            ..wgpu::DeviceDescriptor::default()
        }))
        .map_err(|e| GpuError::NoDevice {
            adapter: info.name.clone(),
            message: e.to_string(),
        })?;
        let lost = Arc::new(OnceLock::new());
        let why = Arc::clone(&lost);
        device.set_device_lost_callback(move |reason, message| {
            // The first reason is the cause of all that follow.
            let _ = why.set(format!("{reason:?}: {message}"));
        });
        let exhausted = Arc::new(Mutex::new(None));
        let note = Arc::clone(&exhausted);
        device.on_uncaptured_error(Arc::new(move |error| on_error(&note, &error)));
        let timestamp_ns = features
            .contains(wgpu::Features::TIMESTAMP_QUERY)
            .then(|| queue.get_timestamp_period());
        Ok(Self {
            depth_clamp: features.contains(wgpu::Features::DEPTH_CLIP_CONTROL),
            timestamp_ns,
            adapter: format!("{} ({})", info.name, info.driver_info).replace(" ()", ""),
            driver: format!("{} {}", info.driver, info.driver_info)
                .trim()
                .to_owned(),
            lost,
            exhausted,
            device,
            queue,
        })
    }
}

/// Notes that memory ran out. What else is reported after that, and before it was told, comes of
/// it: of resources that could not be made. Without that as a reason it is a fault of ours.
fn on_error(exhausted: &Mutex<Option<String>>, error: &wgpu::Error) {
    let mut exhausted = exhausted.lock().unwrap_or_else(PoisonError::into_inner);
    match error {
        wgpu::Error::OutOfMemory { source } if exhausted.is_none() => {
            *exhausted = Some(source.to_string().trim().to_owned());
        }
        _ if exhausted.is_some() => (),
        _ => {
            drop(exhausted);
            panic!("{error}");
        }
    }
}

/// The best of an instance's adapters that fit.
fn adapter(
    instance: &wgpu::Instance,
    surface: Option<&wgpu::Surface<'_>>,
    choice: &AdapterChoice,
) -> Result<wgpu::Adapter, GpuError> {
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    adapters.retain(|a| surface.is_none_or(|surface| a.is_surface_supported(surface)));
    let names: Vec<String> = adapters.iter().map(|a| a.get_info().name).collect();
    let rank = |a: &wgpu::Adapter| match a.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Cpu => 3,
        wgpu::DeviceType::Other => 4,
    };
    adapters.sort_by_key(rank);
    adapters
        .into_iter()
        .find(|a| match choice {
            AdapterChoice::Auto => true,
            AdapterChoice::Cpu => a.get_info().device_type == wgpu::DeviceType::Cpu,
            AdapterChoice::Name(name) => a
                .get_info()
                .name
                .to_lowercase()
                .contains(&name.to_lowercase()),
        })
        .ok_or_else(|| GpuError::NoAdapter {
            choice: choice.clone(),
            found: names,
        })
}
