//! Points, paths and rectangles on the page: millimetres, origin in the upper left corner, y down.

use math::elementary::sin_cos;

/// A point on the page in mm: right, down.
pub type Point = [f64; 2];

/// One step of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Starts a new part.
    Move(Point),
    /// Straight to a point.
    Line(Point),
    /// Cubic Bézier by two control points.
    Cubic(Point, Point, Point),
    /// Back to the start of the part.
    Close,
}

/// Lines and curves; several closed parts are filled by the even–odd rule.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path(pub Vec<Step>);

impl Path {
    /// An open line through the points.
    pub fn polyline(points: &[Point]) -> Self {
        let mut path = Self::default();
        path.add_polyline(points);
        path
    }

    /// A closed polygon.
    pub fn polygon(points: &[Point]) -> Self {
        let mut path = Self::default();
        path.add_polygon(points);
        path
    }

    /// An axis-parallel rectangle.
    pub fn rect(r: Rect) -> Self {
        Self::polygon(&[[r.left, r.top], [r.right, r.top], [r.right, r.bottom], [r.left, r.bottom]])
    }

    /// A circle of four cubic arcs (largest radial error 0.03 %).
    pub fn circle(centre: Point, radius: f64) -> Self {
        let [x, y] = centre;
        let (r, k) = (radius, radius * 4.0 / 3.0 * (2.0_f64.sqrt() - 1.0));
        Self(vec![
            Step::Move([x + r, y]),
            Step::Cubic([x + r, y + k], [x + k, y + r], [x, y + r]),
            Step::Cubic([x - k, y + r], [x - r, y + k], [x - r, y]),
            Step::Cubic([x - r, y - k], [x - k, y - r], [x, y - r]),
            Step::Cubic([x + k, y - r], [x + r, y - k], [x + r, y]),
            Step::Close,
        ])
    }

    /// A ring sector between two radii and two angles (radians, anticlockwise from the right), by short chords.
    pub fn sector(centre: Point, inner: f64, outer: f64, from: f64, to: f64) -> Self {
        let n = (((to - from).abs() / 0.05).ceil() as usize).max(1);
        let at = |r: f64, i: usize| {
            let (s, c) = sin_cos(from + (to - from) * i as f64 / n as f64);
            [centre[0] + r * c, centre[1] - r * s]
        };
        let mut points: Vec<Point> = (0..=n).map(|i| at(outer, i)).collect();
        if inner > 0.0 {
            points.extend((0..=n).rev().map(|i| at(inner, i)));
        } else {
            points.push(centre);
        }
        Self::polygon(&points)
    }

    /// Adds an open line.
    pub fn add_polyline(&mut self, points: &[Point]) {
        for (i, &p) in points.iter().enumerate() {
            self.0.push(if i == 0 { Step::Move(p) } else { Step::Line(p) });
        }
    }

    /// Adds a closed polygon.
    pub fn add_polygon(&mut self, points: &[Point]) {
        if points.len() > 1 {
            self.add_polyline(points);
            self.0.push(Step::Close);
        }
    }

    /// The smallest rectangle around all points and control points; `None` without points.
    pub fn bounds(&self) -> Option<Rect> {
        let points = self.0.iter().flat_map(|step| match *step {
            Step::Move(p) | Step::Line(p) => vec![p],
            Step::Cubic(a, b, p) => vec![a, b, p],
            Step::Close => vec![],
        });
        Rect::around(points)
    }
}

/// An axis-parallel rectangle on the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Smallest x.
    pub left: f64,
    /// Smallest y (the upper edge).
    pub top: f64,
    /// Largest x.
    pub right: f64,
    /// Largest y (the lower edge).
    pub bottom: f64,
}

impl Rect {
    /// From the upper left corner and a size.
    pub fn new(left: f64, top: f64, width: f64, height: f64) -> Self {
        Self { left, top, right: left + width, bottom: top + height }
    }

    /// The smallest rectangle that holds the points.
    pub fn around(points: impl IntoIterator<Item = Point>) -> Option<Self> {
        points.into_iter().fold(None, |sum: Option<Self>, [x, y]| {
            Some(match sum {
                None => Self { left: x, top: y, right: x, bottom: y },
                Some(r) => {
                    Self { left: r.left.min(x), top: r.top.min(y), right: r.right.max(x), bottom: r.bottom.max(y) }
                }
            })
        })
    }

    /// Width in mm.
    pub fn width(&self) -> f64 {
        self.right - self.left
    }

    /// Height in mm.
    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }

    /// Middle.
    pub fn centre(&self) -> Point {
        [(self.left + self.right) / 2.0, (self.top + self.bottom) / 2.0]
    }

    /// The rectangle moved inwards by the four margins.
    pub fn inset(&self, left: f64, top: f64, right: f64, bottom: f64) -> Self {
        Self { left: self.left + left, top: self.top + top, right: self.right - right, bottom: self.bottom - bottom }
    }

    /// Whether the interiors of the two overlap.
    pub fn meets(&self, other: &Self) -> bool {
        self.left < other.right && other.left < self.right && self.top < other.bottom && other.top < self.bottom
    }

    /// Whether `other` lies inside, borders included.
    pub fn holds(&self, other: &Self) -> bool {
        self.left <= other.left && self.top <= other.top && self.right >= other.right && self.bottom >= other.bottom
    }
}

/// Whether two rectangles overlap, each by its corners in order: no side of either separates them.
pub fn meet(a: &[Point; 4], b: &[Point; 4]) -> bool {
    let parts = |side: [f64; 2]| {
        let reach = |c: &[Point; 4]| {
            let along = c.map(|p| p[0] * side[0] + p[1] * side[1]);
            (along.into_iter().fold(f64::INFINITY, f64::min), along.into_iter().fold(f64::NEG_INFINITY, f64::max))
        };
        let ((a0, a1), (b0, b1)) = (reach(a), reach(b));
        a1 <= b0 || b1 <= a0
    };
    ![a, b].iter().any(|c| (0..2).any(|k| parts([c[k + 1][0] - c[k][0], c[k + 1][1] - c[k][1]])))
}
