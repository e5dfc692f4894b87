//! What work costs here: times of lights, explained by what they draw and build.
//!
//! Each stage is taken as a sum of what it has to do, each part at a price of its own and none below
//! zero, fitted to all lights by least squares of errors in parts of the price. A change is predicted from the
//! light's own time, by the ratio of the model after and before: so what the model leaves out of a
//! light, it leaves out on both sides.

use umbrage_lab::profile::GpuCost;

use super::measure::{Base, Figures, Work};

/// Prices, fitted.
#[derive(Clone, Debug)]
pub(super) struct Model {
    volume: Vec<f64>,
    light: Vec<f64>,
    query: Vec<f64>,
    facing: Vec<f64>,
    hidden: Vec<f64>,
    layers: Vec<f64>,
    counters: Vec<f64>,
    emission: Vec<f64>,
    upload: Vec<f64>,
}

/// What a volume draw consists of. Which of its fragments count was not found to matter, on a software
/// rasteriser: all are tested.
fn volume(w: &Work) -> Vec<f64> {
    let polygons = f64::from(w.quads_drawn + w.cap_triangles);
    if polygons == 0.0 {
        return vec![0.0; 3];
    }
    vec![1.0, polygons, w.counts.volume_covered as f64]
}

/// What a light draw consists of; where there is a volume, the stencil is cleaned after it.
fn light(w: &Work) -> Vec<f64> {
    let cleaned = match w.quads_drawn + w.cap_triangles {
        0 => 0.0,
        _ => w.scissor as f64,
    };
    let counts = &w.counts;
    match counts.light_fragments {
        0 => vec![0.0; 4],
        all => vec![1.0, all as f64, counts.shaded_samples as f64, cleaned],
    }
}

/// What a stage consists of that has so many things to look at.
fn each(count: u32) -> Vec<f64> {
    match count {
        0 => vec![0.0; 2],
        n => vec![1.0, f64::from(n)],
    }
}

/// The same where things are looked at in pairs, too.
fn pairs(count: u32) -> Vec<f64> {
    let mut parts = each(count);
    parts.push(f64::from(count).powi(2));
    parts
}

impl Model {
    /// Fits all prices.
    pub(super) fn of(base: &Base) -> Self {
        let drawn = base.drawn.iter().map(|&light| &base.lights[light]);
        let gpu: Vec<(&Figures, GpuCost)> = drawn.filter_map(|f| Some((f, f.gpu?))).collect();
        let on_gpu = |parts: fn(&Work) -> Vec<f64>, us: fn(&GpuCost) -> f64| {
            let samples = gpu.iter().map(|(f, cost)| (parts(&f.work), us(cost)));
            fit(&samples.collect::<Vec<_>>())
        };
        let on_cpu = |parts: fn(&Work) -> Vec<f64>, us: fn(&Figures) -> f64| {
            let built = base.lights.iter().filter(|f| f.build.total_us() > 0.0);
            fit(&built.map(|f| (parts(&f.work), us(f))).collect::<Vec<_>>())
        };
        Self {
            volume: on_gpu(volume, |cost| cost.volume_us),
            light: on_gpu(light, GpuCost::light_us),
            query: on_cpu(|w| each(w.subset), |f| f.build.query_us),
            facing: on_cpu(|w| each(w.subset), |f| f.build.facing_us),
            hidden: on_cpu(|w| pairs(w.casters), |f| f.build.hidden_us),
            layers: on_cpu(|w| each(w.facing), |f| f.build.layers_us),
            counters: on_cpu(|w| each(w.facing), |f| f.build.counters_us),
            emission: on_cpu(|w| each(w.quads), |f| f.build.emission_us),
            upload: on_cpu(|w| each(w.quads), |f| f.upload_us),
        }
    }

    /// GPU microseconds of a light that did `before.work` and would do `after`.
    pub(super) fn gpu_us(&self, before: &Figures, after: &Work) -> Option<f64> {
        let (was, gpu) = (&before.work, before.gpu?);
        let scaled = |us: f64, price: &[f64], parts: fn(&Work) -> Vec<f64>| {
            scaled(us, price, &parts(was), &parts(after))
        };
        Some(
            scaled(gpu.volume_us, &self.volume, volume)
                + scaled(gpu.light_us(), &self.light, light),
        )
    }

    /// CPU microseconds of building it.
    pub(super) fn build_us(&self, before: &Figures, after: &Work) -> f64 {
        let (was, build) = (&before.work, &before.build);
        let of_each = |us: f64, price: &[f64], was: u32, after: u32| {
            scaled(us, price, &each(was), &each(after))
        };
        of_each(build.query_us, &self.query, was.subset, after.subset)
            + of_each(build.facing_us, &self.facing, was.subset, after.subset)
            + scaled(
                build.hidden_us,
                &self.hidden,
                &pairs(was.casters),
                &pairs(after.casters),
            )
            + of_each(build.layers_us, &self.layers, was.facing, after.facing)
            + of_each(build.counters_us, &self.counters, was.facing, after.facing)
            + of_each(build.emission_us, &self.emission, was.quads, after.quads)
            + of_each(before.upload_us, &self.upload, was.quads, after.quads)
    }
}

/// `us`, by the ratio of the prices of `after` and `before`.
fn scaled(us: f64, price: &[f64], before: &[f64], after: &[f64]) -> f64 {
    match cost_of(before, price) {
        0.0 => cost_of(after, price),
        before => us * cost_of(after, price) / before,
    }
}

/// Prices not below zero with the least sum of squared errors in parts of what they make of a sample:
/// errors of what was measured would favour prices that are too low.
fn fit(samples: &[(Vec<f64>, f64)]) -> Vec<f64> {
    let mean = samples.iter().map(|(_, us)| us).sum::<f64>() / samples.len().max(1) as f64;
    let Some(mut price) = first_guess(samples, mean) else {
        return Vec::new();
    };
    let mut costs: Vec<f64> = samples.iter().map(|(_, us)| *us).collect();
    for _ in 0..20 {
        // Small times are mostly noise: they count no more than if they were a tenth of the mean.
        let weights = costs
            .iter()
            .map(|cost| cost.max(0.1 * mean).max(1e-9).powi(-2));
        solve(samples, &weights.collect::<Vec<_>>(), &mut price);
        for (cost, (parts, _)) in costs.iter_mut().zip(samples) {
            *cost = cost_of(parts, &price);
        }
    }
    price
}

/// Weighted least squares by coordinate descent, from `price` on.
fn solve(samples: &[(Vec<f64>, f64)], weights: &[f64], price: &mut [f64]) {
    let size = price.len();
    let (mut gram, mut right) = (vec![0.0; size * size], vec![0.0; size]);
    for ((parts, us), weight) in samples.iter().zip(weights) {
        for (i, a) in parts.iter().enumerate() {
            right[i] += weight * a * us;
            for (j, b) in parts.iter().enumerate() {
                gram[i * size + j] += weight * a * b;
            }
        }
    }
    for _ in 0..1000 {
        for i in 0..size {
            let diagonal = gram[i * size + i];
            if diagonal > 0.0 {
                let others: f64 = (0..size)
                    .filter(|&j| j != i)
                    .map(|j| gram[i * size + j] * price[j])
                    .sum();
                price[i] = ((right[i] - others) / diagonal).max(0.0);
            }
        }
    }
}

fn cost_of(parts: &[f64], price: &[f64]) -> f64 {
    parts.iter().zip(price).map(|(n, p)| n * p).sum()
}

/// Where to start, and where it stays as far as the samples leave it open, as one light does: time is
/// in proportion to the work, to each kind alike; the constant, which comes first, has no share. None
/// without samples.
fn first_guess(samples: &[(Vec<f64>, f64)], mean: f64) -> Option<Vec<f64>> {
    let size = samples.first()?.0.len();
    let kinds = (size - 1).max(1) as f64;
    let of = |kind: usize| {
        let all: f64 = samples.iter().map(|(parts, _)| parts[kind]).sum();
        match (kind, size) {
            (0, 2..) => 0.0,
            _ if all > 0.0 => mean * samples.len() as f64 / all / kinds,
            _ => 0.0,
        }
    };
    Some((0..size).map(of).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prices_that_made_the_times_are_found_again() {
        let made = [3.0, 0.5, 0.01];
        let sample = |i: usize| {
            let parts = vec![1.0, (i * 7 % 13) as f64, (i * i % 101) as f64 * 100.0];
            let us = parts.iter().zip(made).map(|(n, p)| n * p).sum();
            (parts, us)
        };
        let found = fit(&(1..60).map(sample).collect::<Vec<_>>());
        for (found, made) in found.iter().zip(made) {
            assert!((found / made - 1.0).abs() < 1e-3, "{found} {made}");
        }
    }

    #[test]
    fn no_price_is_below_zero_and_no_sample_is_no_price() {
        let samples: Vec<_> = (1..20)
            .map(|i| (vec![1.0, f64::from(i)], 100.0 - f64::from(i)))
            .collect();
        assert!(fit(&samples).iter().all(|&price| price >= 0.0));
        assert!(fit(&[]).is_empty());
    }

    #[test]
    fn one_light_alone_costs_in_proportion_to_its_work() {
        let price = fit(&[(vec![1.0, 200.0, 5000.0], 40.0)]);
        assert!(
            (scaled(40.0, &price, &[1.0, 200.0, 5000.0], &[1.0, 100.0, 2500.0]) - 20.0).abs()
                < 1e-9
        );
    }

    #[test]
    fn a_light_is_scaled_from_its_own_time() {
        assert_eq!(scaled(20.0, &[1.0, 1.0], &[1.0, 9.0], &[1.0, 4.0]), 10.0);
        assert_eq!(scaled(0.0, &[1.0], &[0.0], &[5.0]), 5.0);
    }
}
