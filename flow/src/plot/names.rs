//! Places the names of points so that none lies on another, on a point or outside of the chart.

use super::chart::{DOT, Edges};

/// Gap between a point and its name, in pixels.
const GAP: i32 = 4;
/// Width of a letter and height of a line, in hundredths of the text's size.
const LETTER: i32 = 52;
const LINE: i32 = 85;

/// A rectangle: left, top, right, bottom.
type Area = [i32; 4];

fn overlap(a: Area, b: Area) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

/// A name and the place of its point.
pub(super) struct Name<'a> {
    pub(super) text: &'a str,
    pub(super) at: (i32, i32),
    /// Whether it is written even on top of something else.
    pub(super) is_needed: bool,
}

/// Returns the upper left corner of each name that has room beside its point: to the right, else to the left, above or below. Earlier names
/// get room before later ones. `points` are all points of the chart.
pub(super) fn placed<'a>(
    names: &[Name<'a>],
    points: &[(i32, i32)],
    text_size: i32,
    [left, right, top, bottom]: Edges,
) -> Vec<(&'a str, (i32, i32))> {
    let mut taken: Vec<Area> = points
        .iter()
        .map(|(x, y)| [x - DOT, y - DOT, x + DOT, y + DOT])
        .collect();
    let mut placed = Vec::new();
    for name in names {
        let (x, y) = name.at;
        let (wide, high) = (
            LETTER * text_size * name.text.chars().count() as i32 / 100,
            LINE * text_size / 100,
        );
        let away = DOT + GAP;
        let beside = [y - high / 2, y - high, y].map(|y| [(x + away, y), (x - away - wide, y)]);
        let over = [x - wide / 2, x - wide, x].map(|x| [(x, y - away - high), (x, y + away)]);
        let places = beside.into_iter().chain(over).flatten();
        let places = places
            .map(|(x, y)| [x, y, x + wide, y + high])
            .filter(|area| area[0] >= left && area[2] <= right && area[1] >= top && area[3] <= bottom);
        let covered = |area: &Area| taken.iter().filter(|other| overlap(*area, **other)).count();
        let best = places.min_by_key(covered);
        if let Some(area) = best.filter(|area| name.is_needed || covered(area) == 0) {
            taken.push(area);
            placed.push((name.text, (area[0], area[1])));
        }
    }
    placed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_goes_where_there_is_room_and_one_without_room_is_left_out() {
        let edges = [0, 200, 0, 200];
        let at = |names: &[(&'static str, (i32, i32))], points: &[(i32, i32)], is_needed: bool| {
            let names = names.iter().map(|&(text, at)| Name { text, at, is_needed });
            let placed = placed(&names.collect::<Vec<_>>(), points, 20, edges);
            placed.into_iter().map(|(name, (x, _))| (name, x)).collect::<Vec<_>>()
        };
        // "zv" is 20 wide; 8 lie between the point and its name.
        assert_eq!(at(&[("zv", (100, 100))], &[(100, 100)], false), [("zv", 108)]);
        assert_eq!(at(&[("zv", (195, 100))], &[(195, 100)], false), [("zv", 167)]);
        let near = [(100, 100), (112, 100)];
        assert_eq!(at(&[("zv", near[0])], &near, false), [("zv", 72)]);
        let both = at(&[("ei", near[0]), ("zvd", near[1])], &near, false);
        assert_eq!(both, [("ei", 72), ("zvd", 120)]);
        let crowd: Vec<_> = (0..400).map(|n| (80 + 4 * (n % 20), 80 + 4 * (n / 20))).collect();
        assert_eq!(at(&[("zvdd", (120, 120))], &crowd, false), []);
        assert_eq!(at(&[("zvdd", (120, 120))], &crowd, true).len(), 1);
    }
}
