//! A curve of any number of samples in bounded memory.

/// Largest number of columns: more than a picture has pixels.
const COLUMNS: usize = 4000;

/// Smallest and largest value in each of a few thousand columns of equal width.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    columns: Vec<[f64; 2]>,
    /// Number of samples of a column.
    width: u64,
    samples: u64,
    /// Samples from one value to the next.
    stride: u64,
}

impl Envelope {
    /// An empty curve that gets a value every `stride` samples.
    pub(super) fn new(stride: u64) -> Self {
        Self {
            columns: Vec::new(),
            width: 1,
            samples: 0,
            stride,
        }
    }

    pub(super) fn push(&mut self, value: f64) {
        if self.samples.is_multiple_of(self.width) {
            if self.columns.len() == COLUMNS {
                let pairs = self.columns.chunks(2);
                let joined = pairs.map(|pair| pair.iter().fold([f64::INFINITY, f64::NEG_INFINITY], join));
                self.columns = joined.collect();
                self.width *= 2;
            }
            self.columns.push([value, value]);
        } else if let Some(last) = self.columns.last_mut() {
            *last = join(*last, &[value, value]);
        }
        self.samples += 1;
    }

    /// Number of samples that it spans.
    pub fn samples(&self) -> u64 {
        self.samples * self.stride
    }

    /// Its points, as the number of the sample and the value: all of a short curve, two for each column of a long one.
    pub fn points(&self) -> impl Iterator<Item = (u64, f64)> {
        let width = self.width * self.stride;
        self.columns.iter().enumerate().flat_map(move |(column, [low, high])| {
            let at = column as u64 * width;
            let second = (self.width > 1).then_some((at + width / 2, *high));
            std::iter::once((at, *low)).chain(second)
        })
    }
}

fn join([low, high]: [f64; 2], [other_low, other_high]: &[f64; 2]) -> [f64; 2] {
    [low.min(*other_low), high.max(*other_high)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_curve_is_whole_and_a_long_one_keeps_its_extremes() {
        let mut short = Envelope::new(3);
        (0..5).for_each(|value| short.push(f64::from(value)));
        assert_eq!(
            short.points().collect::<Vec<_>>(),
            [(0, 0.0), (3, 1.0), (6, 2.0), (9, 3.0), (12, 4.0)]
        );
        let mut long = Envelope::new(1);
        let count = 1_000_003u32;
        (0..count).for_each(|k| long.push(if k == 777_777 { 5.0 } else { f64::from(k % 7) - 9.0 }));
        let points: Vec<(u64, f64)> = long.points().collect();
        assert!(points.len() <= 2 * COLUMNS && points.len() > COLUMNS / 2);
        assert_eq!(long.samples(), u64::from(count));
        let (at, highest) = points
            .iter()
            .copied()
            .fold((0, f64::MIN), |a, b| if b.1 > a.1 { b } else { a });
        assert!(highest == 5.0 && at.abs_diff(777_777) < 512, "{at}");
        assert!(points.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
}
