//! Promise: invalid data are an error that names them.
#![allow(clippy::unwrap_used)]

use kinopt_charts::{Axis, Chart, ChartError, Figure};

#[test]
fn chart_rejects_values_off_the_scale() {
    for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        let chart = Chart::new("c")
            .y(Axis::log("cost"))
            .series("s", [(1.0, 1.0), (2.0, bad)]);
        let error = chart.to_svg().unwrap_err();
        assert!(matches!(error, ChartError::BadValue { .. }));
        let text = error.to_string();
        assert!(text.contains("`s`") && text.contains("`cost`"), "{text}");
    }
}

#[test]
fn set_range_draws_outliers_at_its_edge() {
    let chart = |y| {
        Chart::new("c")
            .y(Axis::log("cost").range(1e-6, 1.0))
            .series("s", [(1.0, 1e-3), (2.0, y)])
    };
    let edge = chart(1e-6).to_svg().unwrap();
    for beyond in [0.0, -1.0, 1e-9] {
        assert_eq!(chart(beyond).to_svg().unwrap(), edge);
    }
}

#[test]
fn chart_rejects_empty_data_and_ranges() {
    assert!(matches!(
        Chart::new("none").series("s", []).to_svg(),
        Err(ChartError::Empty { .. })
    ));
    assert!(matches!(
        Figure::new("none").to_svg(),
        Err(ChartError::Empty { .. })
    ));
    for (from, to) in [(1.0, 1.0), (2.0, 1.0), (0.0, f64::NAN)] {
        let chart = Chart::new("c")
            .x(Axis::linear("x").range(from, to))
            .series("s", [(1.0, 1.0)]);
        assert!(matches!(chart.to_svg(), Err(ChartError::BadRange { .. })));
    }
    let chart = Chart::new("c")
        .x(Axis::log("x").range(0.0, 1.0))
        .series("s", [(1.0, 1.0)]);
    assert!(matches!(chart.to_svg(), Err(ChartError::BadRange { .. })));
}

#[test]
fn svg_escapes_names() {
    let svg = Chart::new("a < b & c")
        .series("<s>", [(0.0, 1.0)])
        .to_svg()
        .unwrap();
    assert!(svg.contains("a &lt; b &amp; c") && svg.contains("&lt;s&gt;"));
}
