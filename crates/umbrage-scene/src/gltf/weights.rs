//! Which joints a vertex follows, and how much of each.
//!
//! Takes the joint and weight accessors of a primitive; gives four joints and weights a vertex.
//! Invariant: weights are at least 0 and sum to 1 within rounding, and a joint of weight 0 is
//! joint 0. Of more than four joints the heaviest stay. Source: glTF 2.0 specification, 3.7.3.3.

use super::Context;
use crate::{Scene, SceneError};

/// Joints and weights, one a vertex.
type Influences = (Vec<[u16; 4]>, Vec<[f32; 4]>);

/// Of a vertex whose primitive says nothing: it follows the first joint.
pub(super) const UNBOUND: ([u16; 4], [f32; 4]) = ([0; 4], [1.0, 0.0, 0.0, 0.0]);

/// Largest distance of a file's weights from a sum of 1 that is no oddity: eight weights in bytes,
/// each rounded by itself.
const SLACK: f64 = 8.0 / 255.0;

/// Reads the sets; none, and counted, if one cannot be read or does not fit its `count` positions.
pub(super) fn load(
    context: &mut Context<'_>,
    scene: &mut Scene,
    item: &str,
    sets: &[[usize; 2]],
    count: usize,
) -> Result<Option<Influences>, SceneError> {
    let mut read = Vec::with_capacity(sets.len());
    for &[joints, weights] in sets {
        let joints = context.joints(joints, || item.to_owned());
        let set = joints.and_then(|j| Ok((j, context.vectors::<4>(weights, || item.to_owned())?)));
        let what = match set {
            Ok(set) if set.0.len() == count && set.1.len() == count => {
                read.push(set);
                continue;
            }
            Ok(set) => format!("{} and {} for {count} vertices", set.0.len(), set.1.len()),
            Err(error @ (SceneError::TooLarge { .. } | SceneError::Dangling { .. })) => {
                return Err(error);
            }
            Err(error) => error.to_string(),
        };
        scene.report.dropped_attributes += 1;
        let note = || format!("{item}: joints and weights left out: {what}");
        scene.report.note(note);
        return Ok(None);
    }
    let (mut joints, mut weights) = (Vec::with_capacity(count), Vec::with_capacity(count));
    let mut all = Vec::new();
    for vertex in 0..count {
        all.clear();
        for (joints, weights) in &read {
            all.extend(joints[vertex].into_iter().zip(weights[vertex]));
        }
        let odd = all.iter().any(|(_, w)| !w.is_finite() || *w < 0.0);
        all.retain(|(_, w)| w.is_finite() && *w > 0.0);
        if all.len() > 4 {
            scene.report.dropped_influences += 1;
            all.sort_by(|a, b| b.1.total_cmp(&a.1));
        }
        let sum: f64 = all.iter().map(|(_, w)| f64::from(*w)).sum();
        scene.report.repaired_weights += u64::from(odd || (sum - 1.0).abs() > SLACK);
        all.truncate(4);
        let kept: f64 = all.iter().map(|(_, w)| f64::from(*w)).sum();
        let (mut joint, mut weight) = UNBOUND;
        for (i, (j, w)) in all.iter().enumerate() {
            (joint[i], weight[i]) = (*j, (f64::from(*w) / kept) as f32);
        }
        joints.push(joint);
        weights.push(weight);
    }
    Ok(Some((joints, weights)))
}
