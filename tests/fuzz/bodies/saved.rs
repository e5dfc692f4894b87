//! Saved worlds: bytes to a mapped world, queried and cast from.
//!
//! Checksums are made right first: what is asked is what happens behind them.

use glam::DVec3;
use umbrage_core::world::{Layer, Subset, World, query, reseal};
use umbrage_core::{Light, LightShape};

use super::{Outcome, cast};

pub(crate) fn world(bytes: &[u8]) -> Outcome {
    let mut bytes = bytes.to_vec();
    let fingerprint = reseal(&mut bytes).unwrap_or_default();
    let world = match World::from_saved(&bytes, fingerprint) {
        Ok(world) => world,
        Err(error) => return Outcome::Refused(error.to_string()),
    };
    let lights = [2.0, 1e4, f32::INFINITY].map(|range| Light {
        position: DVec3::new(0.3, 0.7, 0.2),
        range,
        shape: LightShape::Point,
    });
    let mut subset = Subset::default();
    for light in &lights {
        query(&world, Layer::Fixed, light, &mut subset);
        for triangle in subset.triangles() {
            assert!(triangle < world.triangles.len() as u32);
        }
    }
    let sound = world.validate().is_ok();
    // Debug builds check that volumes are closed, which those of an unsound world are not.
    if sound || !cfg!(debug_assertions) {
        let volumes = cast::shadows(&world, &lights);
        assert!(!sound || volumes.check_closed(&world).is_ok());
    }
    Outcome::Used
}
