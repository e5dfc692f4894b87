//! The light list as plain data: a row a light, sorted and filtered.

use umbrage_core::frame::LightPath;
use umbrage_lab::lab::Lab;
use umbrage_lab::stage::StageLight;

use crate::costs::Costs;

/// What a row is sorted by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Column {
    Name,
    Kind,
    Path,
    Quads,
    Build,
    #[default]
    Cost,
}

impl Column {
    pub(crate) fn title(self) -> &'static str {
        match self {
            Column::Name => "light",
            Column::Kind => "kind",
            Column::Path => "path",
            Column::Quads => "quads",
            Column::Build => "build us",
            Column::Cost => "GPU us",
        }
    }
}

/// One light of the last frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    pub(crate) number: usize,
    pub(crate) name: String,
    pub(crate) kind: &'static str,
    pub(crate) path: LightPath,
    /// Drawn in the last frame.
    pub(crate) quads: u32,
    /// Of its volume.
    pub(crate) quads_built: u32,
    /// Whether the frame kept its volume.
    pub(crate) cached: bool,
    pub(crate) build_us: f32,
    pub(crate) gpu_us: Option<f64>,
}

/// Rows of all lights, in their order.
pub(crate) fn rows(lab: &Lab, lights: &[StageLight], costs: &Costs) -> Vec<Row> {
    let lights = lights.iter().zip(&lab.volumes.lights).enumerate();
    lights
        .map(|(number, (light, volume))| Row {
            number,
            name: light.name.clone(),
            kind: light.kind(),
            path: lab.path(number),
            quads: lab.quads_drawn(number),
            quads_built: volume.quads.len() as u32,
            cached: volume.cached,
            build_us: volume.build_us,
            gpu_us: costs.us(number),
        })
        .collect()
}

/// How the list is ordered, and what of it is shown.
#[derive(Clone, Debug, Default)]
pub(crate) struct Order {
    pub(crate) column: Column,
    /// From the other end.
    pub(crate) reversed: bool,
    /// Part of a name; empty for all.
    pub(crate) filter: String,
}

impl Order {
    /// Sorts by a column, or the other way round if it is sorted by it already.
    pub(crate) fn choose(&mut self, column: Column) {
        self.reversed = self.column == column && !self.reversed;
        self.column = column;
    }

    /// Figures begin with the largest, words with A.
    pub(crate) fn apply(&self, rows: &mut Vec<Row>) {
        let wanted = self.filter.to_lowercase();
        rows.retain(|row| row.name.to_lowercase().contains(&wanted));
        rows.sort_by(|a, b| {
            let order = match self.column {
                Column::Name => a.name.cmp(&b.name),
                Column::Kind => a.kind.cmp(b.kind),
                Column::Path => a.path.name().cmp(b.path.name()),
                Column::Quads => b.quads.cmp(&a.quads),
                Column::Build => b.build_us.total_cmp(&a.build_us),
                Column::Cost => {
                    let cost = |row: &Row| row.gpu_us.unwrap_or(-1.0);
                    cost(b).total_cmp(&cost(a)).then(b.quads.cmp(&a.quads))
                }
            };
            if self.reversed {
                order.reverse()
            } else {
                order
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(number: usize, name: &str, quads: u32, gpu_us: Option<f64>) -> Row {
        Row {
            number,
            name: name.to_owned(),
            kind: "point",
            path: LightPath::ZPass { eye_count: 0 },
            quads,
            quads_built: quads,
            cached: true,
            build_us: 0.0,
            gpu_us,
        }
    }

    #[test]
    fn costly_lights_come_first_and_unmeasured_ones_last() {
        let all = [
            row(0, "Torch", 9, None),
            row(1, "lamp", 5, Some(3.0)),
            row(2, "torch 2", 7, Some(8.0)),
        ];
        let of = |order: &Order| {
            let mut rows = all.to_vec();
            order.apply(&mut rows);
            rows.iter().map(|row| row.number).collect::<Vec<_>>()
        };
        let mut order = Order::default();
        assert_eq!(of(&order), [2, 1, 0]);
        order.choose(Column::Quads);
        assert_eq!(of(&order), [0, 2, 1]);
        order.choose(Column::Quads);
        assert_eq!(of(&order), [1, 2, 0]);
        order.choose(Column::Name);
        order.filter = "TORCH".to_owned();
        assert_eq!(of(&order), [0, 2]);
    }
}
