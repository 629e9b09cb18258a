//! A map for a page: a value over two axes, as areas between levels.

use super::Drawn;
use super::chart::{NUMBERS, axis_label};
use super::inline::{Inline, LegendEntry, Picture, SIZE, TEXT_SIZE, Window, hex};
use super::series::{For, grouped};
use crate::failure::Failure;
use plotters::prelude::*;

/// A level of a map.
pub(crate) struct Level {
    /// Largest value on the level; values of lower levels do not belong to it.
    pub(crate) up_to: f64,
    /// Name in the legend.
    pub(crate) name: String,
    /// Colour of its area.
    pub(crate) colour: RGBColor,
}

/// A value on a grid of equally spaced columns and rows.
pub(crate) struct Map {
    /// Heading.
    pub(crate) title: String,
    /// Labels of the axes.
    pub(crate) labels: [String; 2],
    /// Positions of the columns and of the rows, in order; at least two of each.
    pub(crate) columns: Vec<f64>,
    pub(crate) rows: Vec<f64>,
    /// Values as `values[row][column]`.
    pub(crate) values: Vec<Vec<f64>>,
    /// Levels from the lowest on; the last contains all values above the one before.
    pub(crate) levels: Vec<Level>,
    /// A point to mark.
    pub(crate) mark: (f64, f64),
}

impl Map {
    /// The level of a value.
    fn level(&self, value: f64) -> usize {
        let found = self.levels.iter().position(|level| value <= level.up_to);
        found.unwrap_or(self.levels.len().saturating_sub(1))
    }
}

fn ends(of: &[f64]) -> (f64, f64) {
    (of.first().copied().unwrap_or(0.0), of.last().copied().unwrap_or(1.0))
}

/// Draws a map for a page.
pub(crate) fn inline_map(map: &Map) -> Picture {
    let levels = map.levels.iter().map(|level| LegendEntry {
        name: level.name.clone(),
        colour: hex(level.colour),
        form: "area",
    });
    let legend: Vec<LegendEntry> = levels.collect();
    let mut svg = String::new();
    let mut edges = [0; 4];
    let (x, y) = (ends(&map.columns), ends(&map.rows));
    let drawn = (|| -> Drawn {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        let mut chart = ChartBuilder::on(&root)
            .margin(8)
            .margin_right(32)
            .x_label_area_size(34 + 10 * TEXT_SIZE / 13)
            .y_label_area_size(58 + 18 * TEXT_SIZE / 13)
            .build_cartesian_2d(x.0..x.1, y.0..y.1)?;
        let half_column = 0.5 * (x.1 - x.0) / (map.columns.len().max(2) - 1) as f64;
        let half_row = 0.5 * (y.1 - y.0) / (map.rows.len().max(2) - 1) as f64;
        let mut areas: Vec<Vec<_>> = map.levels.iter().map(|_| Vec::new()).collect();
        for (row, values) in map.rows.iter().zip(&map.values) {
            let bottom_to_top = ((row - half_row).max(y.0), (row + half_row).min(y.1));
            let cells: Vec<(f64, usize)> = map
                .columns
                .iter()
                .copied()
                .zip(values.iter().map(|value| map.level(*value)))
                .collect();
            // Neighbours on one level form one area.
            for run in cells.chunk_by(|a, b| a.1 == b.1) {
                let left = (run[0].0 - half_column).max(x.0);
                let right = (run[run.len() - 1].0 + half_column).min(x.1);
                areas[run[0].1].push([(left, bottom_to_top.0), (right, bottom_to_top.1)]);
            }
        }
        for (level, corners) in map.levels.iter().zip(areas) {
            For::Page(&legend).series(&root, &level.name, || {
                let areas = corners.into_iter();
                chart.draw_series(areas.map(|corners| Rectangle::new(corners, level.colour.filled())))?;
                Ok(())
            })?;
        }
        chart
            .configure_mesh()
            .disable_mesh()
            .x_labels(NUMBERS)
            .y_labels(NUMBERS)
            .x_desc(&map.labels[0])
            .y_desc(&map.labels[1])
            .axis_desc_style(("sans-serif", TEXT_SIZE))
            .label_style(("sans-serif", TEXT_SIZE))
            .x_label_formatter(&|value| axis_label(*value))
            .y_label_formatter(&|value| axis_label(*value))
            .draw()?;
        chart.draw_series(std::iter::once(Circle::new(map.mark, 7, WHITE.filled())))?;
        chart.draw_series(std::iter::once(Circle::new(map.mark, 5, RGBColor(1, 1, 1).filled())))?;
        let pixels = chart.plotting_area().get_pixel_range();
        edges = [pixels.0.start, pixels.0.end, pixels.1.start, pixels.1.end];
        root.present()?;
        Ok(())
    })();
    drawn.map_err(|error| Failure::input(format!("cannot draw the map: {error}")))?;
    Ok(Inline {
        title: map.title.clone(),
        svg: grouped(&svg),
        legend,
        points: Vec::new(),
        window: Window {
            edges,
            x,
            y,
            labels: map.labels.clone(),
        },
    })
}
