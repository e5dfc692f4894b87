//! Lights, and handles for them.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec3, Vec3};
use umbrage_core::{Light as CoreLight, LightShape};

use crate::Error;

/// Where a light shines: no colour, no intensity, which are the host's.
///
/// ```
/// use umbrage::Light;
///
/// let lamp = Light::point([0.0, 3.0, 0.0], 12.0);
/// let torch = Light::spot([0.0, 3.0, 0.0], [0.0, -1.0, 0.0], 0.4, 20.0);
/// let sun = Light::directional([0.3, -1.0, 0.2]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light(pub(crate) CoreLight);

impl Light {
    /// In all directions from a point, up to `range` metres; infinity is allowed, and costs.
    pub fn point(position: impl Into<[f64; 3]>, range: f32) -> Self {
        Self(CoreLight {
            position: DVec3::from(position.into()),
            range,
            shape: LightShape::Point,
        })
    }

    /// In a cone from a point: `half_angle_rad` from its axis to where no light falls, 0 to pi.
    pub fn spot(
        position: impl Into<[f64; 3]>,
        direction: impl Into<[f32; 3]>,
        half_angle_rad: f32,
        range: f32,
    ) -> Self {
        let cos_outer = match (0.0..=std::f32::consts::PI).contains(&half_angle_rad) {
            true => half_angle_rad.cos(),
            false => f32::NAN,
        };
        Self(CoreLight {
            position: DVec3::from(position.into()),
            range,
            shape: LightShape::Spot {
                direction: unit(direction.into()),
                cos_outer,
            },
        })
    }

    /// Parallel light from infinitely far, travelling in this direction.
    pub fn directional(direction: impl Into<[f32; 3]>) -> Self {
        Self(CoreLight {
            position: DVec3::ZERO,
            range: f32::INFINITY,
            shape: LightShape::Directional {
                direction: unit(direction.into()),
            },
        })
    }
}

/// Zero, and so refused, if it is no direction.
fn unit(direction: [f32; 3]) -> Vec3 {
    Vec3::from(direction).normalize_or_zero()
}

/// Names a light of one set. Handles of removed lights are refused, also when others take their
/// place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LightId {
    slot: u32,
    stamp: u64,
}

impl LightId {
    /// The light's number: where a host keeps its colour, what callbacks are called with, and its
    /// bit in masks. Numbers are small, and used again once a light is removed.
    pub fn slot(self) -> u32 {
        self.slot
    }
}

/// A set of lights. What changes of it is built again; what does not is kept.
///
/// ```
/// use umbrage::{Light, Lights};
///
/// let mut lights = Lights::default();
/// let lamp = lights.insert(Light::point([0.0, 3.0, 0.0], 12.0))?;
/// lights.set(lamp, Light::point([0.5, 3.0, 0.0], 12.0))?;
/// assert_eq!((lamp.slot(), lights.slots()), (0, 1));
/// lights.remove(lamp)?;
/// assert!(lights.remove(lamp).is_err());
/// # Ok::<(), umbrage::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Lights {
    pub(crate) core: Vec<CoreLight>,
    /// When each was inserted; 0 in a free slot.
    stamps: Vec<u64>,
    free: Vec<u32>,
}

/// What stands in a free slot: no light, and skipped.
const NONE: CoreLight = CoreLight {
    position: DVec3::ZERO,
    range: 0.0,
    shape: LightShape::Point,
};

impl Lights {
    /// Adds a light.
    ///
    /// # Errors
    /// [`Error::Light`].
    pub fn insert(&mut self, light: Light) -> Result<LightId, Error> {
        let light = usable(light)?;
        // One of the process: handles are of one set.
        static NEXT: AtomicU64 = AtomicU64::new(1);
        let stamp = NEXT.fetch_add(1, Ordering::Relaxed);
        let slot = self.free.pop().unwrap_or_else(|| {
            self.core.push(NONE);
            self.stamps.push(0);
            self.core.len() as u32 - 1
        });
        self.core[slot as usize] = light;
        self.stamps[slot as usize] = stamp;
        Ok(LightId { slot, stamp })
    }

    /// Moves or changes a light.
    ///
    /// # Errors
    /// [`Error::UnknownLight`], [`Error::Light`].
    pub fn set(&mut self, id: LightId, light: Light) -> Result<(), Error> {
        let slot = self.slot_of(id)?;
        self.core[slot] = usable(light)?;
        Ok(())
    }

    /// The light as it was last set.
    ///
    /// # Errors
    /// [`Error::UnknownLight`].
    pub fn get(&self, id: LightId) -> Result<Light, Error> {
        Ok(Light(self.core[self.slot_of(id)?]))
    }

    /// Takes a light out.
    ///
    /// # Errors
    /// [`Error::UnknownLight`].
    pub fn remove(&mut self, id: LightId) -> Result<(), Error> {
        let slot = self.slot_of(id)?;
        self.core[slot] = NONE;
        self.stamps[slot] = 0;
        self.free.push(id.slot);
        Ok(())
    }

    /// One more than the largest number that a light of the set has had: what masks are made for,
    /// and a host's own array of lights.
    pub fn slots(&self) -> u32 {
        self.core.len() as u32
    }

    /// Lights in the set.
    pub fn len(&self) -> usize {
        self.core.len() - self.free.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn slot_of(&self, id: LightId) -> Result<usize, Error> {
        match self.stamps.get(id.slot as usize) {
            Some(stamp) if *stamp == id.stamp => Ok(id.slot as usize),
            _ => Err(Error::UnknownLight),
        }
    }
}

fn usable(light: Light) -> Result<CoreLight, Error> {
    match light.0.is_usable() {
        true => Ok(light.0),
        false => Err(Error::Light),
    }
}
