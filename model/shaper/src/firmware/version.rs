//! What the versions of a firmware take.
//!
//! Klipper has had one release since November 2023, and its users run the branch `master`. A version is therefore a count of commits, as Klipper
//! itself writes it: `v0.13.0-633-g19da13507` is the 633rd after the release 0.13.0. A date stands for what `master` had on that day.

use super::klipper::{DampingLimits, EiFormulas};
use super::reprapfirmware::Form;
use thiserror::Error;

/// A firmware.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)] // the names are the documentation
pub enum Firmware {
    Klipper,
    Kalico,
    Marlin,
    MarlinFixedTime,
    RepRapFirmware,
}

impl Firmware {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Firmware::Klipper => "Klipper",
            Firmware::Kalico => "Kalico",
            Firmware::Marlin => "Marlin",
            Firmware::MarlinFixedTime => "Marlin's fixed-time motion",
            Firmware::RepRapFirmware => "RepRapFirmware",
        }
    }

    /// Accepted notations of its versions, for messages.
    pub fn versions(self) -> &'static str {
        match self {
            Firmware::Klipper => {
                "0.9 to 0.13, v0.13.0-633 as Klipper itself reports it, a date such as 2026-03-31, or the branch advanced-features"
            }
            Firmware::Kalico => "main, a release such as v2026.07.00, or the branch bleeding-edge",
            Firmware::Marlin => "2.1.2 and later; without --firmware-version 2.1.3",
            Firmware::MarlinFixedTime => {
                "2 (what `M493 V` reports; Marlin 2.1.3 and builds since October 2025) or 1 (builds of June 2024 to October 2025)"
            }
            Firmware::RepRapFirmware => "3.4 and later, such as 3.5.4 or 3.6.2",
        }
    }
}

/// Why a version is not known.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum VersionError {
    /// The text is no version of this firmware.
    #[error("`{given}` is not a version of {}", .firmware.name())]
    Unknown {
        /// The firmware.
        firmware: Firmware,
        /// What was given.
        given: String,
    },
    /// The version has no input shaper that posicast can write.
    #[error("{} {given} has no input shaper that takes these numbers; the first version that has one is {begins}", .firmware.name())]
    Early {
        /// The firmware.
        firmware: Firmware,
        /// What was given.
        given: String,
        /// The first version that has.
        begins: &'static str,
    },
}

/// Abilities of a version of Klipper or Kalico.
#[derive(Debug, Clone, PartialEq)]
pub struct KlipperVersion {
    /// The version in words, for the output.
    pub name: String,
    /// The firmware.
    pub firmware: Firmware,
    /// Axes that it shapes.
    pub axes: &'static [&'static str],
    /// Formulas of its EI kinds.
    pub ei: EiFormulas,
    /// Largest damping ratios.
    pub damping: DampingLimits,
    /// Whether `ei` and `mzv` take parameters.
    pub has_parameters: bool,
    /// Whether it takes impulses (`custom`) and polynomials (`smoother`).
    pub has_custom: bool,
}

/// Commits of Klipper after the release 0.13.0 that change what it takes or computes, each with its date.
const FITS: (u32, &str) = (273, "2025-09-22");
const DAMPING_LIMITS: (u32, &str) = (324, "2025-10-04");
const Z_AXIS: (u32, &str) = (326, "2025-10-04");
const THREE_HUMPS_MENDED: (u32, &str) = (594, "2026-03-31");
const PARAMETERS: (u32, &str) = (633, "2026-04-27");
/// Day of the release 0.9.0, the first with input shapers.
const RELEASE_0_9: &str = "2020-10-20";

impl KlipperVersion {
    /// The version of Klipper that a text names; the newest without one.
    ///
    /// # Errors
    /// [`VersionError`] for a text that is no version, or one without input shapers.
    pub fn klipper(given: Option<&str>) -> Result<Self, VersionError> {
        const NEWEST: u32 = u32::MAX;
        let firmware = Firmware::Klipper;
        let Some(given) = given else {
            return Ok(Self::after_0_13(NEWEST, "v0.13.0-633 (April 2026) and later".into()));
        };
        if matches!(given, "advanced-features" | "advanced_features") {
            return Ok(Self {
                name: "Klipper's branch advanced-features (github.com/dmbutyugin/klipper, October 2024)".into(),
                firmware,
                axes: &["x", "y"],
                ei: EiFormulas::FitsWithoutCubes,
                damping: DampingLimits::Quarter,
                has_parameters: false,
                has_custom: true,
            });
        }
        let unknown = || VersionError::Unknown {
            firmware,
            given: given.into(),
        };
        let early = || VersionError::Early {
            firmware,
            given: given.into(),
            begins: "0.9 (October 2020)",
        };
        if let Some(date) = date(given) {
            if *date < *RELEASE_0_9 {
                return Err(early());
            }
            let commits = [FITS, DAMPING_LIMITS, Z_AXIS, THREE_HUMPS_MENDED, PARAMETERS];
            // Of a day with a change, the state at its end.
            let last = commits.iter().rev().find(|(_, day)| **day <= *date);
            let name = format!("master of {given}");
            return Ok(match last {
                Some((commits, _)) => Self::after_0_13(*commits, name),
                None => Self::classic(Firmware::Klipper, format!("Klipper's {name}")),
            });
        }
        let numbers = Numbers::of(given).ok_or_else(unknown)?;
        match numbers.first_two() {
            (0, 0..=8) => Err(early()),
            (0, 9..=12) => Ok(Self::classic(firmware, format!("Klipper {given}"))),
            // Without a patch level this is the line of development, which has had no release since.
            (0, 13) => Ok(match (numbers.release.len(), numbers.commits) {
                (2, None) => Self::after_0_13(NEWEST, "0.13, master since April 2026 (v0.13.0-633 and later)".into()),
                (_, commits) => {
                    let commits = commits.unwrap_or(0);
                    Self::after_0_13(commits, format!("v0.13.0-{commits}"))
                }
            }),
            _ => Ok(Self::after_0_13(
                NEWEST,
                format!("{given}, as of v0.13.0-633, which is the newest that posicast knows"),
            )),
        }
    }

    /// The version of Kalico that a text names; without one the branch with `custom`, the newest.
    ///
    /// # Errors
    /// [`VersionError::Unknown`] for a text that is no version.
    pub fn kalico(given: Option<&str>) -> Result<Self, VersionError> {
        let firmware = Firmware::Kalico;
        let given = given.unwrap_or("bleeding-edge");
        if matches!(given, "bleeding-edge" | "bleeding-edge-v2") {
            return Ok(Self {
                name: "Kalico's branch bleeding-edge-v2 (June 2026)".into(),
                firmware,
                axes: &["x", "y"],
                ei: EiFormulas::FitsWithoutCubes,
                damping: DampingLimits::BelowOne,
                has_parameters: false,
                has_custom: true,
            });
        }
        if given != "main" && Numbers::of(given).is_none() {
            return Err(VersionError::Unknown {
                firmware,
                given: given.into(),
            });
        }
        let name = match given {
            "main" => "Kalico's branch main (v2026.07.00)".into(),
            _ => format!("Kalico {given}, branch main"),
        };
        Ok(Self::classic(firmware, name))
    }

    fn classic(firmware: Firmware, name: String) -> Self {
        Self {
            name,
            firmware,
            axes: &["x", "y"],
            ei: EiFormulas::Classic,
            damping: DampingLimits::BelowOne,
            has_parameters: false,
            has_custom: false,
        }
    }

    fn after_0_13(commits: u32, name: String) -> Self {
        let since = |(first, _): (u32, &str)| commits >= first;
        Self {
            name: format!("Klipper {name}"),
            firmware: Firmware::Klipper,
            axes: if since(Z_AXIS) { &["x", "y", "z"] } else { &["x", "y"] },
            ei: match (since(FITS), since(THREE_HUMPS_MENDED)) {
                (false, _) => EiFormulas::Classic,
                (true, false) => EiFormulas::FitsWithoutCubes,
                (true, true) => EiFormulas::Fits,
            },
            damping: if since(DAMPING_LIMITS) {
                DampingLimits::ByKind
            } else {
                DampingLimits::BelowOne
            },
            has_parameters: since(PARAMETERS),
            has_custom: false,
        }
    }
}

/// Abilities of a version of Marlin.
#[derive(Debug, Clone, PartialEq)]
pub struct MarlinVersion {
    /// The version in words, for the output.
    pub name: String,
    /// Axes that it shapes, where its configuration has them.
    pub axes: &'static [&'static str],
    /// Whether `M493` names axes by flags (version 2).
    pub has_axis_flags: bool,
}

impl MarlinVersion {
    /// The version of Marlin for `M593` that a text names; the newest without one.
    ///
    /// # Errors
    /// [`VersionError`] for a text that is no version, or one before 2.1.2.
    pub fn m593(given: Option<&str>) -> Result<Self, VersionError> {
        let firmware = Firmware::Marlin;
        let given = given.unwrap_or("2.1.3");
        let numbers = Numbers::of(given).ok_or_else(|| VersionError::Unknown {
            firmware,
            given: given.into(),
        })?;
        let begins = "2.1.2 (December 2022)";
        let early = VersionError::Early {
            firmware,
            given: given.into(),
            begins,
        };
        let axes: &[&str] = match numbers.first_three() {
            number if number < (2, 1, 2) => return Err(early),
            (2, 1, 2) => &["x", "y"],
            _ => &["x", "y", "z"],
        };
        Ok(Self {
            name: format!("Marlin {given}, M593"),
            axes,
            has_axis_flags: false,
        })
    }

    /// The version of fixed-time motion, `M493`, that a text names; the newest without one.
    ///
    /// # Errors
    /// [`VersionError::Unknown`] for a text that is no version.
    pub fn m493(given: Option<&str>) -> Result<Self, VersionError> {
        let firmware = Firmware::MarlinFixedTime;
        let given = given.unwrap_or("2");
        match given {
            "1" => Ok(Self {
                name: "Marlin's fixed-time motion, version 1 (June 2024 to October 2025)".into(),
                axes: &["x", "y"],
                has_axis_flags: false,
            }),
            "2" | "2.1.3" | "2.1.3.0" => Ok(Self {
                name: "Marlin 2.1.3, fixed-time motion version 2 (M493 V answers \"FTM V2\")".into(),
                axes: &["x", "y", "z"],
                has_axis_flags: true,
            }),
            _ => Err(VersionError::Unknown {
                firmware,
                given: given.into(),
            }),
        }
    }
}

/// Returns the meaning of `M593 P"custom"` in a version of RepRapFirmware, and the version's name; without a text those of the newest.
///
/// # Errors
/// [`VersionError`] for a text that is no version, or one before 3.4.
pub fn reprapfirmware(given: Option<&str>) -> Result<(Form, String), VersionError> {
    let firmware = Firmware::RepRapFirmware;
    let Some(given) = given else {
        return Ok((Form::Amplitudes, "RepRapFirmware 3.6 and later".into()));
    };
    let numbers = Numbers::of(given).ok_or_else(|| VersionError::Unknown {
        firmware,
        given: given.into(),
    })?;
    let name = format!("RepRapFirmware {given}");
    match numbers.first_two() {
        number if number < (3, 4) => Err(VersionError::Early {
            firmware,
            given: given.into(),
            begins: "3.4 (March 2022)",
        }),
        (3, 4 | 5) => Ok((Form::Sums, name)),
        (3, 6) => Ok((Form::Amplitudes, name)),
        _ => Ok((
            Form::Amplitudes,
            format!("{name}, as of 3.6, which is the newest that posicast knows"),
        )),
    }
}

/// A version as numbers: `v0.13.0-633-g19da13507` is the release 0.13.0 and 633 commits.
struct Numbers {
    release: Vec<u32>,
    commits: Option<u32>,
}

impl Numbers {
    fn of(text: &str) -> Option<Self> {
        let text = text.strip_prefix(['v', 'V']).unwrap_or(text);
        // A build such as 3.6.2+1 or 3.6.0-beta.1 counts as its release.
        let mut words = text.split(['-', '+']);
        let release: Option<Vec<u32>> = words.next()?.split('.').map(|number| number.parse().ok()).collect();
        let release = release.filter(|numbers| (1..=4).contains(&numbers.len()))?;
        let commits = words.next().and_then(|word| word.parse().ok());
        Some(Self { release, commits })
    }

    fn at(&self, index: usize) -> u32 {
        self.release.get(index).copied().unwrap_or(0)
    }

    fn first_two(&self) -> (u32, u32) {
        (self.at(0), self.at(1))
    }

    fn first_three(&self) -> (u32, u32, u32) {
        (self.at(0), self.at(1), self.at(2))
    }
}

/// A date `YYYY-MM-DD`, or the last day of a month `YYYY-MM`, in the order of text; `None` for another text.
fn date(text: &str) -> Option<String> {
    let parts: Vec<&str> = text.split('-').collect();
    let number = |text: &str, digits: usize| {
        let fits = text.len() == digits && text.bytes().all(|byte| byte.is_ascii_digit());
        fits.then(|| text.parse::<u32>().ok()).flatten()
    };
    let (year, month) = (number(parts.first()?, 4)?, number(parts.get(1)?, 2)?);
    let day = match parts.as_slice() {
        [_, _] => 31,
        [_, _, day] => number(day, 2)?,
        _ => return None,
    };
    let fits = (1..=12).contains(&month) && (1..=31).contains(&day);
    fits.then(|| format!("{year:04}-{month:02}-{day:02}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn klipper(text: &str) -> KlipperVersion {
        KlipperVersion::klipper(Some(text)).unwrap()
    }

    #[test]
    fn klippers_commits_and_dates_decide_what_it_takes() {
        // git describe of Klipper's own repository: what the commit before each change and the change itself have.
        for (before, after, of) in [
            ("v0.13.0-272-gabc", "v0.13.0-273-g5da026a33", "fits"),
            ("v0.13.0-325", "v0.13.0-326-gcaf7accf2", "z"),
            ("v0.13.0-593", "v0.13.0-594-g0d1445a72", "three humps"),
            ("v0.13.0-632-gabc-dirty", "v0.13.0-633", "parameters"),
            ("2025-09-21", "2025-09-22", "fits"),
            ("2025-10-03", "2025-10-04", "z"),
            ("2026-03-30", "2026-03-31", "three humps"),
            ("2026-03", "2026-04", "parameters"),
        ] {
            let state = |text: &str| {
                let version = klipper(text);
                match of {
                    "fits" => version.ei != EiFormulas::Classic,
                    "z" => version.axes.contains(&"z"),
                    "three humps" => version.ei == EiFormulas::Fits,
                    _ => version.has_parameters,
                }
            };
            assert_eq!((state(before), state(after)), (false, true), "{of}: {before}, {after}");
        }
        assert_eq!(klipper("v0.13.0").ei, EiFormulas::Classic);
        assert_eq!(klipper("0.12").axes, ["x", "y"]);
        for newest in ["0.13", "0.14", "1.0", "2027-01-01"] {
            let version = klipper(newest);
            assert!(version.has_parameters && version.axes.len() == 3, "{newest}");
        }
        assert!(klipper("advanced-features").has_custom);
    }

    #[test]
    fn text_that_is_not_a_version_is_refused() {
        for wrong in [
            "",
            "new",
            "0.8",
            "0.13.x",
            "2019-05-01",
            "v",
            "0..13",
            "1.2.3.4.5",
            "99999999999.1",
        ] {
            assert!(KlipperVersion::klipper(Some(wrong)).is_err(), "{wrong}");
        }
        assert!(KlipperVersion::kalico(Some("master")).is_err());
        for wrong in ["3.3", "2.02", "three", "-1"] {
            assert!(reprapfirmware(Some(wrong)).is_err(), "{wrong}");
        }
        for wrong in ["2.1.1", "2.0.9.7", "1.1.9", "x"] {
            assert!(MarlinVersion::m593(Some(wrong)).is_err(), "{wrong}");
        }
        assert!(MarlinVersion::m493(Some("3")).is_err());
    }

    #[test]
    fn reprapfirmware_changed_with_3_6() {
        for (text, form) in [
            ("3.4", Form::Sums),
            ("3.5.4", Form::Sums),
            ("v3.5.0-rc.3", Form::Sums),
            ("3.6", Form::Amplitudes),
            ("3.6.2+1", Form::Amplitudes),
            ("3.6.0-beta.1", Form::Amplitudes),
            ("3.7.0", Form::Amplitudes),
            ("4.0", Form::Amplitudes),
        ] {
            assert_eq!(reprapfirmware(Some(text)).unwrap().0, form, "{text}");
        }
        assert_eq!(reprapfirmware(None).unwrap().0, Form::Amplitudes);
    }
}
