use super::*;
use crate::analysis::residual_vibration;

/// A kernel, and its samples on a fine grid.
fn fine(kind: ShaperKind, mode: &Mode, tolerance: f64) -> (Kernel, ImpulseSequence) {
    let kernel = Kernel::new(kind, mode, tolerance).unwrap();
    let impulses = kernel.sampled(kind, kernel.duration_s / 256.0).unwrap();
    (kernel, impulses)
}

#[test]
fn golden_durations_are_those_of_a_second_solution() {
    // By Simpson's rule and a scan over θ, or the method of Nelder and Mead, in another program.
    let mode = |damping| Mode {
        frequency_hz: 40.0,
        damping,
    };
    for (kind, damping, tolerance, periods) in [
        (ShaperKind::SmoothZv, 0.0, 0.05, 0.79614),
        (ShaperKind::SmoothZv, 0.3, 0.05, 0.79614),
        (ShaperKind::SmoothZvd, 0.0, 0.05, 1.2656),
        (ShaperKind::SmoothZvd, 0.2, 0.05, 1.2656),
        (ShaperKind::SmoothEi, 0.0, 0.05, 1.2592),
        (ShaperKind::SmoothEi, 0.2, 0.05, 1.2516),
        (ShaperKind::SmoothEi, 0.05, 0.2, 1.2440),
        (ShaperKind::SmoothMzv, 0.1, 0.05, 0.94346),
        (ShaperKind::SmoothTwoHumpEi, 0.0, 0.05, 1.75988),
        (ShaperKind::SmoothTwoHumpEi, 0.2, 0.01, 1.78779),
        (ShaperKind::SmoothZvdEi, 0.0, 0.05, 1.50706),
        (ShaperKind::SmoothZvdEi, 0.1, 0.02, 1.58541),
        (ShaperKind::SmoothSi, 0.0, 0.05, 1.47243),
        (ShaperKind::SmoothSi, 0.1, 0.1, 1.25147),
    ] {
        let found = Kernel::new(kind, &mode(damping), tolerance).unwrap().duration_s;
        let found = found / mode(damping).damped_period_s();
        assert!((found - periods).abs() < 1e-3, "{kind} {damping} {tolerance}: {found}");
    }
}

#[test]
fn samples_keep_what_the_kernel_promises_and_sum_to_one() {
    for damping in [0.0, 0.1, 0.3] {
        let mode = Mode {
            frequency_hz: 31.0,
            damping,
        };
        for (kind, promised) in [
            (ShaperKind::SmoothZv, 0.0),
            (ShaperKind::SmoothZvd, 0.0),
            (ShaperKind::SmoothEi, 0.05),
            (ShaperKind::SmoothMzv, 0.0),
            (ShaperKind::SmoothTwoHumpEi, 0.0),
            (ShaperKind::SmoothZvdEi, 0.0),
            (ShaperKind::SmoothSi, 0.0),
        ] {
            let (_, impulses) = fine(kind, &mode, 0.05);
            let list = impulses.impulses();
            assert!(list.iter().all(|impulse| impulse.amplitude >= 0.0), "{kind}");
            assert!((list.iter().map(|impulse| impulse.amplitude).sum::<f64>() - 1.0).abs() < 1e-12);
            let residual = residual_vibration(list, &mode);
            assert!((residual - promised).abs() < 2e-3, "{kind} {damping}: {residual}");
            // The kernel rises from 0: the second cell has three times what the first has.
            let rise = list[1].amplitude / list[0].amplitude;
            assert!((2.0..4.0).contains(&rise), "{kind} {damping}: {rise}");
        }
    }
}

#[test]
fn the_flat_kinds_are_flat_at_the_mode() {
    let mode = Mode {
        frequency_hz: 50.0,
        damping: 0.0,
    };
    let at = |impulses: &ImpulseSequence, ratio: f64| residual_vibration(impulses.impulses(), &mode.scaled(ratio));
    let (_, zv) = fine(ShaperKind::SmoothZv, &mode, 0.05);
    let (_, zvd) = fine(ShaperKind::SmoothZvd, &mode, 0.05);
    let (_, ei) = fine(ShaperKind::SmoothEi, &mode, 0.05);
    for ratio in [0.97, 1.03] {
        assert!(at(&zvd, ratio) < 0.15 * at(&zv, ratio));
        // The mode is the peak between two zeros.
        assert!(at(&ei, ratio) < at(&ei, 1.0));
    }
}

#[test]
fn damping_makes_the_kernel_asymmetric() {
    let mode = |damping| Mode {
        frequency_hz: 50.0,
        damping,
    };
    let mean = |damping: f64| {
        let (kernel, impulses) = fine(ShaperKind::SmoothZv, &mode(damping), 0.05);
        impulses.delay_s() / kernel.duration_s
    };
    assert!((mean(0.0) - 0.5).abs() < 3e-3, "{}", mean(0.0));
    assert!(mean(0.2) < 0.45, "{}", mean(0.2));
}

#[test]
fn smooth_ei_ends_where_its_error_says() {
    let mode = |damping| Mode {
        frequency_hz: 50.0,
        damping,
    };
    let refused = Kernel::new(ShaperKind::SmoothEi, &mode(0.9), 0.05).unwrap_err();
    let DesignError::Damping { most, .. } = refused else {
        panic!("{refused}");
    };
    assert!(Kernel::new(ShaperKind::SmoothEi, &mode(most), 0.05).is_ok());
    assert!(Kernel::new(ShaperKind::SmoothEi, &mode(most + 0.001), 0.05).is_err());
}

#[test]
fn cells_grow_until_a_table_holds_the_kernels() {
    let kernel = Kernel::new(
        ShaperKind::SmoothZv,
        &Mode {
            frequency_hz: 20.0,
            damping: 0.0,
        },
        0.05,
    )
    .unwrap();
    // 0.796 periods of 50 ms are 398 samples at 10 kHz.
    assert_eq!(samples_per_cell(&[kernel], 10_000.0), 2.0);
    assert_eq!(samples_per_cell(&[kernel], 5_000.0), 1.0);
    assert_eq!(samples_per_cell(&[kernel, kernel], 10_000.0), 4.0);
}

/// The residual of a kernel by Simpson's rule at a mode of another frequency, at the kernel's end.
fn by_simpson(kernel: &Kernel, mode: &Mode) -> f64 {
    let steps = 800;
    let (mut sine, mut cosine, mut whole) = (0.0, 0.0, 0.0);
    for step in 0..=steps {
        let weight = match step {
            0 | 800 => 1.0,
            _ if step % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let time_s = kernel.duration_s * f64::from(step) / f64::from(steps);
        let value = weight * kernel.value(time_s);
        let left = value * (mode.decay() * (time_s - kernel.duration_s)).exp();
        whole += value;
        sine += left * (mode.omega_damped() * time_s).sin();
        cosine += left * (mode.omega_damped() * time_s).cos();
    }
    sine.hypot(cosine) / whole
}

/// The residual at frequencies relative to the mode, from `from` to `to`: its peaks, and the largest of all.
fn over_band(kernel: &Kernel, mode: &Mode, [from, to]: [f64; 2]) -> (Vec<f64>, f64) {
    let looks = 300;
    let residuals: Vec<f64> = (0..=looks)
        .map(|look| {
            by_simpson(
                kernel,
                &mode.scaled(from + (to - from) * f64::from(look) / f64::from(looks)),
            )
        })
        .collect();
    let peaks = residuals
        .windows(3)
        .filter(|three| three[1] > three[0] && three[1] >= three[2])
        .map(|three| three[1]);
    (peaks.collect(), residuals.iter().copied().fold(0.0, f64::max))
}

#[test]
fn humps_are_as_high_as_the_tolerance_and_lower_with_damping() {
    // Bands in which the kinds promise it: from the lowest zero on, or from the mode on.
    for (kind, tolerance, band, humps) in [
        (ShaperKind::SmoothTwoHumpEi, 0.05, [0.75, 1.3], 2),
        (ShaperKind::SmoothTwoHumpEi, 0.002, [0.93, 1.07], 2),
        (ShaperKind::SmoothTwoHumpEi, 0.4, [0.68, 1.36], 2),
        (ShaperKind::SmoothZvdEi, 0.05, [0.9, 1.55], 1),
        (ShaperKind::SmoothZvdEi, 0.003, [0.97, 1.2], 1),
        (ShaperKind::SmoothZvdEi, 0.4, [0.9, 1.9], 1),
        (ShaperKind::SmoothSi, 0.05, [1.0, 6.0], 2),
        (ShaperKind::SmoothSi, 0.01, [1.0, 6.0], 2),
        (ShaperKind::SmoothSi, 0.4, [1.0, 12.0], 2),
    ] {
        for damping in [0.0, 0.02, 0.1, 0.3] {
            let mode = Mode {
                frequency_hz: 31.0,
                damping,
            };
            let kernel = Kernel::new(kind, &mode, tolerance).unwrap();
            let (peaks, most) = over_band(&kernel, &mode, band);
            assert!(most <= tolerance * (1.0 + 1e-4), "{kind} {tolerance} {damping}: {most}");
            if damping == 0.0 {
                let high = peaks.iter().filter(|peak| **peak > tolerance * (1.0 - 1e-2)).count();
                assert_eq!(high, humps, "{kind} {tolerance}: {peaks:?}");
            } else {
                assert!(most < tolerance, "{kind} {tolerance} {damping}: {most}");
            }
            assert!(by_simpson(&kernel, &mode) < 1e-6, "{kind}");
            let least = (0..=1000).map(|step| kernel.value(kernel.duration_s * f64::from(step) / 1000.0));
            assert!(
                least.fold(f64::INFINITY, f64::min) > -1e-12,
                "{kind} {tolerance} is negative somewhere"
            );
        }
    }
}

#[test]
fn smooth_mzv_has_the_zeros_of_mzv() {
    let mode = Mode {
        frequency_hz: 31.0,
        damping: 0.0,
    };
    let kernel = Kernel::new(ShaperKind::SmoothMzv, &mode, 0.05).unwrap();
    let impulses = crate::design::zv::design_mzv(&mode).unwrap();
    for ratio in [1.0, 5.0 / 3.0] {
        let other = mode.scaled(ratio);
        assert!(residual_vibration(impulses.impulses(), &other) < 1e-12);
        assert!(by_simpson(&kernel, &other) < 1e-6, "{ratio}");
    }
    assert!(by_simpson(&kernel, &mode.scaled(4.0 / 3.0)) > 0.1);
}

#[test]
fn a_tolerance_out_of_range_is_refused_with_the_range() {
    let mode = Mode {
        frequency_hz: 31.0,
        damping: 0.02,
    };
    for (kind, tolerance) in [
        (ShaperKind::SmoothSi, 0.005),
        (ShaperKind::SmoothTwoHumpEi, 0.6),
        (ShaperKind::SmoothZvdEi, 1e-5),
    ] {
        let refused = Kernel::new(kind, &mode, tolerance).unwrap_err();
        let DesignError::Tolerance { least, most, .. } = refused else {
            panic!("{refused}");
        };
        for allowed in [least, most] {
            assert!(Kernel::new(kind, &mode, allowed).is_ok(), "{kind} {allowed}");
        }
    }
}

#[test]
fn golden_insensitivities_are_those_of_the_page() {
    // docs/shaper-design.md, undamped at 5 %: the lowest and the highest frequency, relative to the mode.
    let mode = Mode {
        frequency_hz: 40.0,
        damping: 0.0,
    };
    for (kind, low, high) in [
        (ShaperKind::SmoothZv, 0.9647, 1.0358),
        (ShaperKind::SmoothMzv, 0.9488, 1.0592),
        (ShaperKind::SmoothEi, 0.7927, 1.2194),
        (ShaperKind::SmoothZvd, 0.8496, 1.1572),
        (ShaperKind::SmoothSi, 0.9194, 9.0),
        (ShaperKind::SmoothZvdEi, 0.8207, 1.6442),
        (ShaperKind::SmoothTwoHumpEi, 0.6300, 1.4106),
    ] {
        let kernel = Kernel::new(kind, &mode, 0.05).unwrap();
        let at = |ratio: f64| by_simpson(&kernel, &mode.scaled(ratio));
        assert!((at(low) - 0.05).abs() < 2e-3, "{kind}: {}", at(low));
        assert!(at(low - 0.01) > 0.05, "{kind}");
        if kind == ShaperKind::SmoothSi {
            assert!(at(high) < 5e-3, "{}", at(high));
        } else {
            assert!((at(high) - 0.05).abs() < 2e-3, "{kind}: {}", at(high));
            assert!(at(high + 0.01) > 0.05, "{kind}");
        }
    }
}
