//! The papers' figures, redrawn from our shapers.

use super::designs::{mode_of_omega, shaper};
use super::{antisymmetry, contour, hybrid_ei, negative_shapers, plants};
use posicast_machine::plant::response::step_response;
use posicast_shaper::analysis::sensitivity_curve;
use posicast_shaper::design::DesignError;
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::vibrationless::{gain, optimum};
use posicast_shaper::impulse::{Impulse, ImpulseSequence};

/// Number of points of a curve.
const POINTS: usize = 801;

/// One diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Heading.
    pub title: String,
    /// Quantity on the horizontal axis, with its unit.
    pub x_label: &'static str,
    /// Quantity on the vertical axis, with its unit.
    pub y_label: &'static str,
    /// Curves.
    pub curves: Vec<FigureCurve>,
}

/// A named curve.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureCurve {
    /// Name in the legend.
    pub name: String,
    /// Points `(x, y)` in order of x.
    pub points: Vec<(f64, f64)>,
    /// Whether this is a level or curve for comparison only.
    pub reference: bool,
}

fn curve(name: impl Into<String>, points: Vec<(f64, f64)>) -> FigureCurve {
    FigureCurve {
        name: name.into(),
        points,
        reference: false,
    }
}

/// Returns a horizontal line from `low` to `high`, the ends of the curves.
fn level(name: &str, low: f64, high: f64, at: f64) -> FigureCurve {
    FigureCurve {
        name: name.into(),
        points: vec![(low, at), (high, at)],
        reference: true,
    }
}

/// Returns `POINTS` evenly spaced values from `low` to `high`.
fn spaced(low: f64, high: f64) -> impl Iterator<Item = f64> {
    (0..POINTS).map(move |k| low + (high - low) * k as f64 / (POINTS - 1) as f64)
}

/// Draws the sensitivity curves of the five hybrids, and the periodicity on which the shaper for many modes rests.
pub(super) fn hybrid_ei() -> Result<Vec<Figure>, DesignError> {
    let mode = mode_of_omega(20.0, 0.0);
    let sensitivity = |kind: ShaperKind, high: f64| -> Result<Vec<(f64, f64)>, DesignError> {
        let designed = shaper(kind, &[mode])?;
        let points = sensitivity_curve(designed.impulses(), &mode, 0.0, high, POINTS);
        Ok(points
            .into_iter()
            .map(|(ratio, residual)| (ratio, 100.0 * residual))
            .collect())
    };
    let mut near = vec![level("5 %", 0.0, 2.0, 5.0)];
    for (name, kind) in hybrid_ei::TABLE_1 {
        near.push(curve(name, sensitivity(kind, 2.0)?));
    }
    let far = vec![
        level("5 %", 0.0, 8.0, 5.0),
        curve("EI", sensitivity(ShaperKind::ZvEi, 8.0)?),
        curve("Multi-EI", sensitivity(ShaperKind::MultiEi, 8.0)?),
    ];
    let figure = |title: &str, curves| Figure {
        title: title.into(),
        x_label: "ω / ω_sys",
        y_label: "residual vibration, %",
        curves,
    };
    Ok(vec![
        figure("Sensitivity of the hybrids, tolerance 5 %", near),
        figure("Periodicity: the tolerance holds round every odd multiple", far),
    ])
}

/// Draws the step responses of positive, negative and plain negative shapers on both modes of the robot.
pub(super) fn negative_hybrid() -> Result<Vec<Figure>, DesignError> {
    type Design = fn((usize, usize)) -> Result<(String, ImpulseSequence), DesignError>;
    let figure = |title: &str, pairs: &[(usize, usize)], design: Design| -> Result<Figure, DesignError> {
        let plant = negative_shapers::plant();
        let mut curves = vec![level("target", 0.0, 30.0, 1.0)];
        for pair in pairs {
            let (name, designed) = design(*pair)?;
            let points = step_response(&plant, designed.impulses(), 0.03, POINTS);
            curves.push(curve(name, in_milliseconds(points)));
        }
        Ok(Figure {
            title: title.into(),
            x_label: "time, ms",
            y_label: "position / step",
            curves,
        })
    };
    Ok(vec![
        figure("Positive hybrids", &negative_shapers::PAIRS, negative_shapers::positive)?,
        figure("Negative hybrids", &negative_shapers::PAIRS, negative_shapers::negative)?,
        figure(
            "One negative kind for both modes",
            &negative_shapers::PLAIN,
            negative_shapers::negative,
        )?,
    ])
}

fn in_milliseconds(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.into_iter().map(|(time_s, y)| (1e3 * time_s, y)).collect()
}

/// Draws the residual spectra of the cascades of greatest robustness.
pub(super) fn vibrationless() -> Result<Vec<Figure>, DesignError> {
    const EPSILON: f64 = 0.05;
    let spectrum = |ratios: &[f64], high: f64| -> Vec<(f64, f64)> {
        spaced(2.0 - high, high)
            .map(|omega| (omega, 2.0 * gain(ratios, omega)))
            .collect()
    };
    let (mut whole, mut near) = (
        vec![level("ε = 0.05", 0.2, 1.8, EPSILON)],
        vec![level("ε = 0.05", 0.6, 1.4, EPSILON)],
    );
    for order in 1..=5 {
        let cascade = optimum(order, EPSILON)?;
        let name = format!("n = {order}, Δ = {:.4}", cascade.index);
        whole.push(curve(&name, spectrum(&cascade.ratios, 1.8)));
        let close = spectrum(&cascade.ratios, 1.4).into_iter().filter(|(_, r)| *r <= 0.2);
        if order > 1 {
            near.push(curve(&name, close.collect()));
        }
    }
    let figure = |title: &str, curves| Figure {
        title: title.into(),
        x_label: "ω / ω_0",
        y_label: "R, at most 2|P|",
        curves,
    };
    Ok(vec![
        figure("Residual spectrum of the cascades", whole),
        figure("The same, near the bound", near),
    ])
}

/// Draws the responses of the two-mode example to a shaped impulse, undamped and damped.
pub(super) fn antisymmetry() -> Result<Vec<Figure>, DesignError> {
    let figure = |title: &str, damping: f64| -> Result<Figure, DesignError> {
        let modes = antisymmetry::example_modes(damping);
        let response = |impulses: &[Impulse]| -> Vec<(f64, f64)> {
            let at = |time_s: f64| -> f64 {
                let passed = impulses.iter().filter(|i| i.time_s <= time_s);
                let terms = passed.flat_map(|i| {
                    let passed_s = time_s - i.time_s;
                    modes
                        .iter()
                        .map(move |m| i.amplitude * (-m.decay() * passed_s).exp() * (m.omega_damped() * passed_s).sin())
                });
                terms.sum()
            };
            spaced(0.0, 10.0).map(|time_s| (time_s, at(time_s))).collect()
        };
        Ok(Figure {
            title: title.into(),
            x_label: "time, s",
            y_label: "response to a shaped impulse",
            curves: vec![
                FigureCurve {
                    reference: true,
                    ..curve("unshaped", response(ImpulseSequence::unity().impulses()))
                },
                curve(
                    "two impulses",
                    response(&antisymmetry::antisymmetric("two-impulse", &modes)?),
                ),
                curve(
                    "three impulses",
                    response(&antisymmetry::antisymmetric("three-impulse", &modes)?),
                ),
                curve("classical, four", response(shaper(ShaperKind::Zv, &modes)?.impulses())),
            ],
        })
    };
    Ok(vec![
        figure("Modes 2 and 14 rad/s, undamped", 0.0)?,
        figure("Modes 2 and 14 rad/s, damping 0.01", 0.01)?,
    ])
}

/// Draws the step responses of the X axis on plants that deviate from the model, and the radius along the circle.
pub(super) fn xy_stage() -> Result<Vec<Figure>, DesignError> {
    const KINDS: [(&str, ShaperKind); 3] = [
        ("unshaped", ShaperKind::None),
        ("ZV", ShaperKind::Zv),
        ("ZVD", ShaperKind::Zvd),
    ];
    let x = &plants::PLANTS[0];
    let mut figures = Vec::new();
    for (ratio, name) in [
        (0.9, "10 % slower than modelled"),
        (1.0, "as modelled"),
        (1.1, "10 % faster than modelled"),
    ] {
        let mut curves = vec![level("target", 0.0, 40.0, 1.0)];
        for (kind_name, kind) in KINDS {
            let designed = shaper(kind, &[x.mode()])?;
            let points = step_response(&x.plant().scaled(ratio), designed.impulses(), 0.04, POINTS);
            curves.push(curve(kind_name, in_milliseconds(points)));
        }
        figures.push(Figure {
            title: format!("Step of the {} axis, plant {name}", x.name),
            x_label: "time, ms",
            y_label: "position / step",
            curves,
        });
    }
    for (ratio, name) in [(1.0, "plants as modelled"), (0.9, "plants 10 % slower")] {
        let mut curves = vec![level("the circle", 0.0, 60.0, 0.0)];
        for (kind_name, kind) in KINDS {
            let shapers = [
                shaper(kind, &[plants::PLANTS[0].mode()])?,
                shaper(kind, &[plants::PLANTS[1].mode()])?,
            ];
            let points = contour::radius_errors_mm(&shapers, ratio, 0.06);
            curves.push(curve(kind_name, in_milliseconds(points)));
        }
        figures.push(Figure {
            title: format!("Circle of 10 mm at 100 mm/s, {name}"),
            x_label: "time, ms",
            y_label: "radius − 10 mm, mm",
            curves,
        });
    }
    Ok(figures)
}
