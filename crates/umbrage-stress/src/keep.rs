//! A failure, made small and kept as a file.
//!
//! Takes a failure; gives the file of a smaller case that fails in the same way, and, where reading
//! that file back and drawing it shows a wrong mask, the command line that does so. A wrong count at
//! a point in the air shows in no picture: there a small triangle is put to it, and a camera before
//! that.

use std::path::{Path, PathBuf};

use glam::DVec3;
use umbrage_core::{Casting, Light};
use umbrage_lab::lab::Method;
use umbrage_scene::SceneError;

use crate::campaign::{Failure, Fault};
use crate::case::{Case, look};
use crate::exact::Point;
use crate::file;
use crate::masks::Studio;
use crate::points::{self, PointFault};
use crate::shrink::shrink;
use crate::surface::source;

/// A failure in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// Where.
    pub file: PathBuf,
    /// Of the smaller case.
    pub triangles: usize,
    /// What shows the failure of the file, if `umbrage check` does.
    pub command: Option<String>,
}

/// Shrinks a failure and writes it into a folder.
///
/// # Errors
/// What the system says about writing.
pub fn keep(
    failure: &Failure,
    mut studio: Option<&mut Studio>,
    folder: &Path,
) -> Result<Kept, SceneError> {
    let name = failure.id.to_string().replace(':', "-");
    let path = folder.join(format!("{name}.glb"));
    let case = failure.id.make();
    let mut small = match (&failure.fault, studio.as_deref_mut()) {
        (Fault::Mask(fault), Some(studio)) => {
            // As a file says it, if it fails so too.
            let mut start = case.clone();
            start.views = vec![case.views[fault.view]];
            let mut fails = |case: &Case| fails_as_mask(studio, case, Some(fault.method));
            if fails(&start) {
                file::write(&start, &path)?;
                if let Some(read) = file::read(&path).ok().filter(|read| fails(read)) {
                    start = read;
                }
                shrink(&start, &mut fails)
            } else {
                case
            }
        }
        (Fault::Mask(_), None) => case,
        (Fault::Volume(fault), _) => {
            let mut start = case.clone();
            start.points.extend(place(fault));
            let kind = std::mem::discriminant(fault);
            let fails = |case: &Case| {
                let found = points::check(case).fault;
                found.is_some_and(|found| std::mem::discriminant(&found) == kind)
            };
            shrink(&start, &mut |case| fails(case))
        }
    };
    if let Fault::Volume(_) = failure.fault
        && let Some(studio) = studio.as_deref_mut()
        && let Some(fault) = points::check(&small).fault
        && let Some(seen) = visible(&small, &fault)
        && fails_as_mask(studio, &seen, None)
    {
        small = seen;
    }
    file::write(&small, &path)?;
    let command = studio.and_then(|studio| {
        let read = file::read(&path).ok()?;
        let fault = studio.check(&read).ok()?.fault?;
        Some(file::command(&path, fault.method))
    });
    Ok(Kept {
        file: path,
        triangles: small.mesh.triangles.len(),
        command,
    })
}

/// Whether a mask is wrong, of this method if one is named.
fn fails_as_mask(studio: &mut Studio, case: &Case, method: Option<Method>) -> bool {
    let found = studio.check(case).ok().and_then(|report| report.fault);
    found.is_some_and(|fault| method.is_none_or(|method| method == fault.method))
}

/// Where a count is wrong.
fn place(fault: &PointFault) -> Option<DVec3> {
    match fault {
        PointFault::Count { at, .. } | PointFault::Parts { at, .. } => Some(*at),
        PointFault::Between { to, .. } => Some(*to),
        PointFault::Refused(_) | PointFault::Open { .. } | PointFault::Eye { .. } => None,
    }
}

/// The case with a receiver where its count is wrong, turned to the light, and a camera before it.
fn visible(case: &Case, fault: &PointFault) -> Option<Case> {
    let at = place(fault)?;
    let light: &Light = case.lights.first()?;
    let (toward, distance) = match source(light) {
        Point::Near(position) => (position - at, position.distance(at)),
        Point::Far(toward) => (toward, f64::from(case.size())),
    };
    let toward = toward.try_normalize()?;
    let size = distance / 64.0;
    let (u, v) = toward.any_orthonormal_pair();
    let corner = |x: f64, y: f64| at + (u * x + v * y) * size;
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.0, 1.0)];
    let mut seen = case.clone();
    seen.triangle(corners.map(DVec3::as_vec3), Casting::Both);
    seen.mesh.put(case.mesh.positions.len(), corners);
    let eye = at + (toward + u * 0.5) * (4.0 * size);
    seen.views = vec![look(eye, at, case.size() * 1e-6)];
    Some(seen)
}
