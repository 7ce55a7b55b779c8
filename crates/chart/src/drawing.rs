//! Draws a chart.

use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{PathElement, Polygon, Rectangle, Text};
use plotters::prelude::SVGBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, IntoFont, RGBColor, ShapeStyle, TextStyle};

use super::axis::Scale;
use super::axis::Spanned;
use super::chart::{Chart, Rate, Series};
use super::names::apart;
use super::notes::{Bounds, along, beside};
use super::style::{COLOURS, INK, UNIT, marker, style_sheet};

/// How large a chart is, and where its names stand.
#[derive(Debug, Clone, Copy)]
struct Layout {
    /// Of the area inside the axes (pixels).
    size: Place,
    /// Whether names stand below the chart, one a line, and not beside it.
    below: bool,
    /// Most ticks across and up.
    ticks: (usize, usize),
}

/// For wide pages.
const WIDE: Layout = Layout {
    size: (600, 400),
    below: false,
    ticks: (11, 11),
};
/// As wide as a telephone.
const NARROW: Layout = Layout {
    size: (270, 200),
    below: true,
    ticks: (5, 7),
};
/// Room left of it, above and below (pixels).
const ROOM: (i32, i32, i32) = (80, 50, 52);
/// Free edge left of it (pixels).
const EDGE: i32 = 5;
/// Free right of a chart whose names are below (pixels).
const RIGHT: i32 = 25;
/// Between the title of the lower axis and names below it (pixels).
const GAP: i32 = 8;
/// Height of text (pixels).
const TEXT: f64 = 15.0;
/// Width of a letter, against the height of text.
const LETTER: f64 = 0.53;
/// Distance between names (pixels).
const LINE: i32 = 19;
/// Length of a rate's triangle along x (decades).
const TRIANGLE: f64 = 0.5;

type Place = (i32, i32);
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Context<'a, 'b> = ChartContext<'b, SVGBackend<'a>, Cartesian2d<Spanned, Spanned>>;
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

impl Chart {
    /// The chart as an SVG document.
    pub fn svg(&self) -> String {
        svg(self, WIDE)
    }

    /// The same so narrow that it can be read on a telephone, with the names below.
    pub fn narrow_svg(&self) -> String {
        svg(self, NARROW)
    }
}

fn svg(chart: &Chart, layout: Layout) -> String {
    let (width, height) = layout.whole(chart);
    let mut text = String::new();
    let backend =
        SVGBackend::with_string(&mut text, ((width * UNIT) as u32, (height * UNIT) as u32));
    // A backend that writes into memory has no error to report.
    let drawn = draw(chart, layout, &backend.into_drawing_area());
    debug_assert!(drawn.is_ok(), "{drawn:?}");
    let units = format!("width=\"{}\" height=\"{}\"", width * UNIT, height * UNIT);
    let text = text.replacen(&units, &format!("width=\"{width}\" height=\"{height}\""), 1);
    let (opening, rest) = text.split_once('\n').unwrap_or_default();
    format!("{opening}\n{}{rest}", style_sheet(rest))
}

impl Layout {
    /// Width and height (pixels), with room for all names.
    fn whole(self, chart: &Chart) -> Place {
        let (width, height) = (ROOM.0 + self.size.0, ROOM.1 + self.size.1 + ROOM.2);
        match self.below {
            true => (width + RIGHT, height + GAP + LINE * names(chart) as i32),
            false => (width + beside_width(chart), height),
        }
    }

    /// Left end and height of a title (pixels), which on a telephone is made to fit.
    fn title(self, text: &str) -> (i32, f64) {
        if !self.below {
            return (ROOM.0, 1.1 * TEXT);
        }
        let room = f64::from(ROOM.0 + self.size.0 + RIGHT - 2 * EDGE);
        let fits = room / (LETTER * text.chars().count().max(1) as f64);
        (EDGE, fits.min(1.1 * TEXT))
    }

    /// Lower edge of the area inside the axes (units).
    fn bottom(self) -> i32 {
        (ROOM.1 + self.size.1) * UNIT
    }
}

/// Number of names that a chart has.
fn names(chart: &Chart) -> usize {
    chart.series.len() + usize::from(chart.front) + usize::from(chart.band.is_some())
}

/// Width of names beside a chart (pixels), with room for the longest.
fn beside_width(chart: &Chart) -> i32 {
    let names = chart
        .series
        .iter()
        .map(|series| series.name.chars().count());
    let band = chart
        .band
        .as_ref()
        .map_or(0, |band| band.name.chars().count());
    let notes = [FRONT.chars().count(), band];
    let longest = names.chain(notes).max().unwrap_or(0) as f64;
    45 + (LETTER * TEXT * longest).ceil() as i32
}

/// Name of the front.
const FRONT: &str = "best of all";

fn text_style(size: f64) -> TextStyle<'static> {
    // The backend divides by 1.24.
    let units = 1.24 * size * f64::from(UNIT);
    ("sans-serif", units).into_font().color(&INK)
}

fn stroke(colour: RGBColor, pixels: f64) -> ShapeStyle {
    colour.stroke_width((pixels * f64::from(UNIT)) as u32)
}

/// Behind the lines of the series.
fn front_style() -> ShapeStyle {
    ShapeStyle {
        color: INK.mix(0.5),
        ..stroke(INK, 5.0)
    }
}

/// Behind everything.
fn band_style() -> ShapeStyle {
    INK.mix(0.25).filled()
}

/// What a name beside the chart stands for.
enum Mark {
    /// A series, by number.
    Series(usize),
    /// The front.
    Front,
    /// The band.
    Band,
}

fn draw(chart: &Chart, layout: Layout, area: &Area<'_>) -> Drawn {
    let points = || chart.series.iter().flat_map(|series| &series.points);
    let x = chart.x.over(points().map(|point| point.0), layout.ticks.0);
    let shown = points().filter(|&&point| chart.shows(point));
    let band = chart.band.iter().map(|band| band.below);
    let heights = shown.map(|point| point.1).chain(band);
    let y = chart.y.over(heights, layout.ticks.1);
    let (width, height) = layout.whole(chart);
    let below = height - ROOM.1 - layout.size.1 - ROOM.2;
    let mut context = ChartBuilder::on(area)
        .margin_left(EDGE * UNIT)
        .margin_top(ROOM.1 * UNIT)
        .margin_right((width - ROOM.0 - layout.size.0) * UNIT)
        .margin_bottom(below * UNIT)
        .x_label_area_size(ROOM.2 * UNIT)
        .y_label_area_size((ROOM.0 - EDGE) * UNIT)
        .build_cartesian_2d(x, y)?;
    draw_axes(chart, &mut context)?;
    let (left, size) = layout.title(&chart.title);
    let title = text_style(size).pos(Pos::new(HPos::Left, VPos::Center));
    let text = Text::new(chart.title.as_str(), (left * UNIT, 15 * UNIT), title);
    area.draw(&text)?;
    let sheet = Sheet {
        chart,
        layout,
        area,
        top: y.top(),
        place: &|x, y| context.backend_coord(&(x, y)),
    };
    sheet.draw_band()?;
    sheet.draw_front()?;
    for (number, series) in chart.series.iter().enumerate() {
        sheet.draw_series(number, series)?;
    }
    for rate in &chart.rates {
        sheet.draw_rate(rate)?;
    }
    sheet.draw_names()?;
    sheet.draw_notes()?;
    sheet.note_failures()
}

fn draw_axes(chart: &Chart, context: &mut Context<'_, '_>) -> Drawn {
    context
        .configure_mesh()
        .axis_style(stroke(INK, 1.0))
        .bold_line_style(ShapeStyle {
            color: INK.mix(0.3),
            ..stroke(INK, 0.7)
        })
        .label_style(text_style(0.9 * TEXT))
        .axis_desc_style(text_style(TEXT))
        .set_all_tick_mark_size(5 * UNIT)
        .x_desc(chart.x.title.as_str())
        .y_desc(chart.y.title.as_str())
        .draw()
}

/// What is drawn on.
struct Sheet<'a, 'b> {
    chart: &'a Chart,
    layout: Layout,
    area: &'a Area<'b>,
    /// Value of `y` at the upper edge.
    top: f64,
    /// From values to units.
    place: &'a dyn Fn(f64, f64) -> Place,
}

impl Sheet<'_, '_> {
    /// Where a point is drawn; none if its place is not on the chart.
    fn at(&self, (x, y): (f64, f64)) -> Option<Place> {
        let Chart {
            x: across, y: up, ..
        } = self.chart;
        self.chart
            .shows((x, y))
            .then(|| (self.place)(across.at(x), up.at(y)))
    }

    /// Where the cross of a failed point of a series is drawn.
    fn cross_of(&self, number: usize, (x, y): (f64, f64)) -> Option<Place> {
        let failed = !y.is_finite() && self.chart.x.takes(x);
        failed.then(|| {
            let (across, up) = (self.place)(self.chart.x.at(x), self.top);
            (across, up + self.row(number) * 11 * UNIT)
        })
    }

    /// Row of the crosses of a series: the next one for each series that failed somewhere.
    fn row(&self, number: usize) -> i32 {
        let before = self.chart.series[..number].iter();
        let fails = |series: &&Series| series.points.iter().any(|point| !point.1.is_finite());
        before.filter(fails).count() as i32
    }

    fn path(&self, points: Vec<Place>, style: ShapeStyle) -> Drawn {
        self.area.draw(&PathElement::new(points, style))
    }

    fn text(&self, text: &str, at: Place, style: TextStyle<'_>) -> Drawn {
        self.area.draw(&Text::new(text, at, style))
    }

    fn marker(&self, number: usize, at: Place) -> Drawn {
        let colour = COLOURS[number % COLOURS.len()].filled();
        self.area.draw(&Polygon::new(marker(number, at), colour))
    }

    fn cross(&self, (x, y): Place, colour: RGBColor) -> Drawn {
        let arm = 5 * UNIT;
        for slope in [arm, -arm] {
            let ends = vec![(x - arm, y - slope), (x + arm, y + slope)];
            self.path(ends, stroke(colour, 2.5))?;
        }
        Ok(())
    }

    fn draw_series(&self, number: usize, series: &Series) -> Drawn {
        let colour = COLOURS[number % COLOURS.len()];
        // A failure between two points interrupts the line.
        let stretches = series.points.split(|&point| self.at(point).is_none());
        for stretch in stretches.filter(|stretch| series.line && stretch.len() > 1) {
            let places = stretch.iter().filter_map(|&point| self.at(point));
            self.path(places.collect(), stroke(colour, 2.0))?;
        }
        for &point in &series.points {
            if let Some(at) = self.at(point) {
                self.marker(number, at)?;
            } else if let Some(at) = self.cross_of(number, point) {
                self.cross(at, colour)?;
            }
        }
        Ok(())
    }

    /// Names right of the chart, as high as the last points are, or below it, each with its marker.
    fn draw_names(&self) -> Drawn {
        let last = |number: usize| {
            let mut points = self.chart.series[number].points.iter().rev();
            points.find_map(|&point| self.at(point).or(self.cross_of(number, point)))
        };
        let bottom = self.layout.bottom();
        let mut ends: Vec<(Mark, &str, i32)> = Vec::new();
        for (number, series) in self.chart.series.iter().enumerate() {
            let height = last(number).map_or(bottom, |place| place.1);
            ends.push((Mark::Series(number), &series.name, height));
        }
        if let (true, Some(&end)) = (self.chart.front, self.chart.front_points().last()) {
            ends.push((
                Mark::Front,
                FRONT,
                self.at(end).map_or(bottom, |place| place.1),
            ));
        }
        if let Some((band, edge)) = self.chart.band.as_ref().zip(self.edge_of_band()) {
            ends.push((Mark::Band, &band.name, edge));
        }
        let wanted: Vec<i32> = ends.iter().map(|end| end.2).collect();
        let (heights, left) = match self.layout.below {
            true => {
                let first = bottom + (ROOM.2 + GAP + LINE / 2) * UNIT;
                let lines = (0..ends.len() as i32).map(|line| first + line * LINE * UNIT);
                (lines.collect(), 30 * UNIT)
            }
            false => {
                let heights = apart(&wanted, LINE * UNIT, ROOM.1 * UNIT, bottom);
                (heights, (ROOM.0 + self.layout.size.0 + 18) * UNIT)
            }
        };
        for ((mark, name, _), height) in ends.into_iter().zip(heights) {
            let sample = vec![(left - 9 * UNIT, height), (left + 9 * UNIT, height)];
            match mark {
                Mark::Series(number) => {
                    if self.chart.series[number].line {
                        self.path(sample, stroke(COLOURS[number % COLOURS.len()], 2.0))?;
                    }
                    self.marker(number, (left, height))?;
                }
                Mark::Front => self.path(sample, front_style())?,
                Mark::Band => {
                    let half = 6 * UNIT;
                    let corners = [(sample[0].0, height - half), (sample[1].0, height + half)];
                    self.area.draw(&Rectangle::new(corners, band_style()))?;
                }
            }
            let style = text_style(TEXT).pos(Pos::new(HPos::Left, VPos::Center));
            self.text(name, (left + 15 * UNIT, height), style)?;
        }
        Ok(())
    }

    /// Says above the chart what a cross means.
    fn note_failures(&self) -> Drawn {
        let mut points = self.chart.series.iter().flat_map(|series| &series.points);
        if !points.any(|&point| self.cross_of(0, point).is_some()) {
            return Ok(());
        }
        let at = ((ROOM.0 + 8) * UNIT, (ROOM.1 - 14) * UNIT);
        self.cross(at, INK)?;
        let style = text_style(0.9 * TEXT).pos(Pos::new(HPos::Left, VPos::Center));
        self.text(&self.chart.failure, (at.0 + 12 * UNIT, at.1), style)
    }

    fn draw_front(&self) -> Drawn {
        match self.chart.front {
            true => self.path(self.stairs(), front_style()),
            false => Ok(()),
        }
    }

    /// The front: between two points nothing better is known than the left one.
    fn stairs(&self) -> Vec<Place> {
        let points = self.chart.front_points().into_iter();
        let places: Vec<Place> = points.filter_map(|point| self.at(point)).collect();
        let stairs = places.windows(2);
        let mut line: Vec<Place> = stairs
            .flat_map(|pair| [pair[0], (pair[1].0, pair[0].1)])
            .collect();
        line.extend(places.last());
        line
    }

    /// Height of the upper edge of the band, if there is one and it has a place.
    fn edge_of_band(&self) -> Option<i32> {
        let below = self.chart.band.as_ref()?.below;
        let takes = self.chart.y.takes(below);
        takes.then(|| (self.place)(1.0, self.chart.y.at(below)).1)
    }

    fn draw_band(&self) -> Drawn {
        let Some(edge) = self.edge_of_band() else {
            return Ok(());
        };
        let (left, right) = (ROOM.0 * UNIT, (ROOM.0 + self.layout.size.0) * UNIT);
        let corners = [(left, edge), (right, self.layout.bottom())];
        self.area.draw(&Rectangle::new(corners, band_style()))?;
        self.path(vec![(left, edge), (right, edge)], stroke(INK, 1.0))
    }

    /// The notes of the series, where they stand on nothing else.
    fn draw_notes(&self) -> Drawn {
        let all = self.chart.series.iter();
        let places = |series: &Series| -> Vec<Place> {
            series
                .points
                .iter()
                .filter_map(|&point| self.at(point))
                .collect()
        };
        let mut taken = along(&self.stairs(), 4 * UNIT);
        for series in all.clone() {
            let places = places(series);
            let markers = places
                .iter()
                .map(|&at| Bounds::around(at, (14 * UNIT, 14 * UNIT)));
            taken.extend(markers);
            taken.extend(along(&places, 4 * UNIT));
        }
        let low = (ROOM.0 * UNIT, ROOM.1 * UNIT);
        let right = low.0 + self.layout.size.0 * UNIT;
        let area = Bounds([low.0, low.1, right, self.layout.bottom()]);
        for (number, series) in all.enumerate() {
            let Some(note) = &series.note else {
                continue;
            };
            let width = (0.6 * TEXT * note.chars().count() as f64) as i32;
            let size = (width * UNIT, (1.1 * TEXT) as i32 * UNIT);
            if let Some(at) = beside(&places(series), size, area, &taken) {
                taken.push(Bounds::around(at, size));
                let colour = COLOURS[number % COLOURS.len()];
                let style = text_style(0.9 * TEXT).pos(Pos::new(HPos::Center, VPos::Center));
                self.text(note, at, style.color(&colour))?;
            }
        }
        Ok(())
    }

    /// Below the middle point of the series, where it ends.
    fn draw_rate(&self, rate: &Rate) -> Drawn {
        let logarithmic = Scale::Logarithmic;
        let Some(series) = self.chart.series.get(rate.series) else {
            return Ok(());
        };
        let shown = series
            .points
            .iter()
            .filter(|&&point| self.chart.shows(point));
        let shown: Vec<(f64, f64)> = shown.copied().collect();
        let both = [self.chart.x.scale, self.chart.y.scale] == [logarithmic; 2];
        if shown.is_empty() || !both {
            return Ok(());
        }
        let (x, y) = shown[shown.len() / 2];
        let further = x * 10.0_f64.powf(TRIANGLE);
        let (start, end) = (
            (self.place)(x, y),
            (self.place)(further, y * 10.0_f64.powf(TRIANGLE * rate.rate)),
        );
        let down = 14 * UNIT;
        let (start, end) = ((start.0, start.1 + down), (end.0, end.1 + down));
        // The right angle lies on the side away from the series.
        let low = start.1.max(end.1);
        let foot = if end.1 > start.1 { start.0 } else { end.0 };
        let corners = vec![start, end, (foot, low), start];
        self.path(corners, stroke(INK, 1.5))?;
        let style = text_style(0.9 * TEXT).pos(Pos::new(HPos::Center, VPos::Top));
        let middle = ((start.0 + end.0) / 2, low + 3 * UNIT);
        self.text(&format!("{}", rate.rate).replace('-', "−"), middle, style)
    }
}
