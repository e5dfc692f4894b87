//! The value of a curve at a time.
//!
//! Source: glTF 2.0 specification, appendix C: step, linear, spherical linear, cubic spline.

use glam::{DQuat, DVec4};

use super::{Curve, Interpolation};

impl Curve {
    /// Values a key.
    pub(crate) fn values_a_key(interpolation: Interpolation) -> usize {
        match interpolation {
            Interpolation::CubicSpline => 3,
            _ => 1,
        }
    }

    /// Whether it has a key, and values for each.
    pub(super) fn is_whole(&self) -> bool {
        let each = Self::values_a_key(self.interpolation);
        !self.times_s.is_empty() && self.values.len() == each * self.times_s.len()
    }

    /// The value at a time: of the first key before it, of the last key after it.
    pub(super) fn at(&self, time_s: f64, is_rotation: bool) -> DVec4 {
        let last = self.times_s.len() - 1;
        let after = self.times_s.partition_point(|&t| f64::from(t) <= time_s);
        if after == 0 || after > last {
            return unit(self.key(after.min(last)), is_rotation);
        }
        let [from, to] = [after - 1, after];
        let [start, end] = [from, to].map(|key| f64::from(self.times_s[key]));
        let (s, length) = ((time_s - start) / (end - start), end - start);
        match self.interpolation {
            Interpolation::Step => unit(self.key(from), is_rotation),
            Interpolation::Linear if is_rotation => {
                let [a, b] = [from, to].map(|key| rotation(self.key(key)));
                a.slerp(b, s).into()
            }
            Interpolation::Linear => self.key(from).lerp(self.key(to), s),
            Interpolation::CubicSpline => {
                let [s2, s3] = [s * s, s * s * s];
                let value = self.key(from) * (2.0 * s3 - 3.0 * s2 + 1.0)
                    + self.values[3 * from + 2].as_dvec4() * length * (s3 - 2.0 * s2 + s)
                    + self.key(to) * (3.0 * s2 - 2.0 * s3)
                    + self.values[3 * to].as_dvec4() * length * (s3 - s2);
                unit(value, is_rotation)
            }
        }
    }

    fn key(&self, key: usize) -> DVec4 {
        match self.interpolation {
            Interpolation::CubicSpline => self.values[3 * key + 1],
            _ => self.values[key],
        }
        .as_dvec4()
    }
}

/// Of unit length, if it stands for a rotation.
fn unit(value: DVec4, is_rotation: bool) -> DVec4 {
    if is_rotation {
        rotation(value).into()
    } else {
        value
    }
}

/// No rotation where a spline passes through zero.
fn rotation(value: DVec4) -> DQuat {
    DQuat::from_vec4(value.try_normalize().unwrap_or(DVec4::W))
}
