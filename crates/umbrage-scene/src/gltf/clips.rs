//! Animations: curves over time for parts of nodes.
//!
//! Takes the root and the visited tree; gives one clip for each animation, under the same index.
//! A reference that leads nowhere is an error; a channel whose values cannot be used is left out
//! and counted. Source: glTF 2.0 specification, section 3.11.

use glam::Vec4;

use gltf::json::animation::{Channel as Source, Interpolation as Way, Property, Sampler};
use gltf::json::validation::Checked;

use super::nodes::Tree;
use super::{Context, name_or};
use crate::rig::{Channel, Clip, Curve, Interpolation, Local, Part};
use crate::{Scene, SceneError};

/// Loads every animation.
pub(super) fn load(
    context: &mut Context<'_>,
    scene: &mut Scene,
    tree: &Tree,
) -> Result<Vec<Clip>, SceneError> {
    let root = context.root;
    let mut clips = Vec::with_capacity(root.animations.len());
    for (index, animation) in root.animations.iter().enumerate() {
        let name = name_or(&animation.name, "animation", index);
        let mut channels = Vec::new();
        for (number, source) in animation.channels.iter().enumerate() {
            let item = format!("animation {index} ({name}), channel {number}");
            let sampler = source.sampler.value();
            let sampler =
                context.resolve(&animation.samplers, sampler, "sampler", || item.clone())?;
            match channel(context, tree, source, sampler, &item) {
                Ok(Ok(channel)) => channels.push(channel),
                Ok(Err(what)) => {
                    scene.report.skipped_channels += 1;
                    scene.report.note(|| format!("{item} left out: {what}"));
                }
                Err(error) => return Err(error),
            }
        }
        let ends = channels.iter().filter_map(|c| c.curve.times_s.last());
        clips.push(Clip {
            name,
            duration_s: ends.fold(0.0, |end, &t| f64::max(end, t.into())),
            channels,
        });
    }
    Ok(clips)
}

/// One channel, or why it is left out.
fn channel(
    context: &mut Context<'_>,
    tree: &Tree,
    source: &Source,
    sampler: &Sampler,
    item: &str,
) -> Result<Result<Channel, String>, SceneError> {
    let named = || item.to_owned();
    let (root, node) = (context.root, source.target.node.value());
    context.resolve(&root.nodes, node, "node", named)?;
    for accessor in [sampler.input, sampler.output] {
        context.resolve(&root.accessors, accessor.value(), "accessor", named)?;
    }
    let part = match source.target.path {
        Checked::Valid(Property::Translation) => Part::Translation,
        Checked::Valid(Property::Rotation) => Part::Rotation,
        Checked::Valid(Property::Scale) => Part::Scale,
        _ => return Ok(Err("morph weights, or an unknown path".to_owned())),
    };
    let interpolation = match sampler.interpolation {
        Checked::Valid(Way::Linear) => Interpolation::Linear,
        Checked::Valid(Way::Step) => Interpolation::Step,
        Checked::Valid(Way::CubicSpline) => Interpolation::CubicSpline,
        Checked::Invalid => return Ok(Err("unknown interpolation".to_owned())),
    };
    let Some(node) = tree.place[node] else {
        return Ok(Err(format!("node {node} is not in the scene")));
    };
    if let Local::Matrix(_) = tree.nodes[node as usize].local {
        return Ok(Err("its node has a matrix".to_owned()));
    }
    let times = read(context.vectors::<1>(sampler.input.value(), named))?;
    let output = sampler.output.value();
    let values = match part {
        Part::Rotation => read(context.vectors::<4>(output, named))?
            .map(|values| values.into_iter().map(Vec4::from).collect()),
        _ => read(context.vectors::<3>(output, named))?.map(|values| {
            values
                .iter()
                .map(|&[x, y, z]| Vec4::new(x, y, z, 0.0))
                .collect()
        }),
    };
    let curve = times.and_then(|times| {
        Ok(Curve {
            interpolation,
            times_s: times.into_flattened(),
            values: values?,
        })
    });
    Ok(curve
        .and_then(usable)
        .map(|curve| Channel { node, part, curve }))
}

/// Data that cannot be read leaves out its channel; an error that is the whole file's stays one.
fn read<T>(values: Result<T, SceneError>) -> Result<Result<T, String>, SceneError> {
    match values {
        Ok(values) => Ok(Ok(values)),
        Err(error @ (SceneError::TooLarge { .. } | SceneError::Dangling { .. })) => Err(error),
        Err(error) => Ok(Err(error.to_string())),
    }
}

/// The curve, if its times ascend and it has finite values for all of them.
fn usable(curve: Curve) -> Result<Curve, String> {
    let (keys, values) = (curve.times_s.len(), curve.values.len());
    let each = Curve::values_a_key(curve.interpolation);
    if keys == 0 || keys.checked_mul(each) != Some(values) {
        return Err(format!("{values} values for {keys} keys"));
    }
    let ascend = curve.times_s.windows(2).all(|t| t[0] < t[1]);
    if !ascend || curve.times_s[0] < 0.0 || !curve.times_s.iter().all(|t| t.is_finite()) {
        return Err("its times do not ascend from zero".to_owned());
    }
    if !curve.values.iter().all(|v| v.is_finite()) {
        return Err("a value is not finite".to_owned());
    }
    Ok(curve)
}
