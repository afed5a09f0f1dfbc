//! Circles of wires.
//!
//! A wire reads its source at the time when its block is called. So a circle through the outputs of a block is an
//! ordinary feedback that takes a scan. A circle of inputs that also read a variable or an output is a latch. A
//! circle of inputs that read nothing else is neither: it never gets a value.

use crate::error::{Code, Diagnostic};
use crate::model::{Instance, Point, Span};
use std::collections::{BTreeMap, BTreeSet};

/// An input pin: instance and pin index.
type Place = (usize, usize);

/// The wired inputs, their sources, and the place of their name.
pub(super) type Wires = BTreeMap<Place, (Vec<Point>, Span)>;

/// The first circle of inputs that nothing feeds, in the direction of reading. Every wire is followed
/// once.
pub(super) fn dead(wires: &Wires) -> Option<Vec<Place>> {
    let wired = |point: &Point| match point {
        Point::Pin(instance, pin) => Some((*instance, *pin)).filter(|place| wires.contains_key(place)),
        // Signals that an expression reads may feed it.
        Point::Input(_) | Point::Symbol(..) | Point::Formula(_) => None,
    };
    let mut readers: BTreeMap<Place, Vec<Place>> = BTreeMap::new();
    let mut fed: BTreeSet<Place> = BTreeSet::new();
    let mut open: Vec<Place> = Vec::new();
    for (place, (sources, _)) in wires {
        for source in sources {
            match wired(source) {
                Some(source) => readers.entry(source).or_default().push(*place),
                None if fed.insert(*place) => open.push(*place),
                None => {}
            }
        }
    }
    while let Some(place) = open.pop() {
        for reader in readers.get(&place).into_iter().flatten() {
            if fed.insert(*reader) {
                open.push(*reader);
            }
        }
    }
    // All sources of an unfed input are unfed inputs, so following them ends in a circle.
    let mut way: Vec<Place> = Vec::new();
    let mut on_way: BTreeSet<Place> = BTreeSet::new();
    let mut place = *wires.keys().find(|place| !fed.contains(place))?;
    while on_way.insert(place) {
        way.push(place);
        place = wires
            .get(&place)
            .and_then(|(sources, _)| sources.iter().find_map(wired))?;
    }
    Some(way.into_iter().skip_while(|before| *before != place).collect())
}

/// The message for a circle.
pub(super) fn error(circle: &[Place], wires: &Wires, blocks: &[Instance]) -> Diagnostic {
    let name = |place: &Place| {
        let block = blocks.get(place.0);
        let pin = block.and_then(|block| block.block.pins().nth(place.1));
        format!(
            "{}.{}",
            block.map_or("", |block| &block.name),
            pin.map_or("", |pin| pin.name)
        )
    };
    let names: Vec<String> = circle.iter().chain(circle.first()).map(name).collect();
    let span = |place: Option<&Place>| place.and_then(|place| wires.get(place)).map(|(_, span)| *span);
    let message = format!("inputs are wired in a circle: {}", names.join(" <- "));
    let diagnostic = Diagnostic::new(Code::WireCycle, span(circle.first()).unwrap_or_default(), message)
        .help("no value ever gets in; wire one of them from an output or an input variable");
    match circle.get(1) {
        Some(second) => diagnostic.related(span(Some(second)).unwrap_or_default(), "read by it"),
        None => diagnostic,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wires(list: &[(Place, &[Point])]) -> Wires {
        list.iter()
            .map(|(place, points)| (*place, (points.to_vec(), Span::default())))
            .collect()
    }

    #[test]
    fn only_circles_into_which_nothing_feeds_are_dead() {
        let (a, b, c) = ((0, 1), (1, 1), (2, 1));
        let pin = |place: Place| Point::Pin(place.0, place.1);
        let find = |list: &[(Place, &[Point])]| dead(&wires(list));
        assert_eq!(find(&[(a, &[pin(a)])]), Some(vec![a]));
        assert_eq!(find(&[(a, &[pin(b)]), (b, &[pin(a)])]), Some(vec![a, b]));
        // `a` only reads the circle.
        assert_eq!(
            find(&[(a, &[pin(b)]), (b, &[pin(c)]), (c, &[pin(b)])]),
            Some(vec![b, c])
        );
        // A latch, a chain, a feedback through an output.
        assert_eq!(find(&[(a, &[pin(b)]), (b, &[pin(a), Point::Input(0)])]), None);
        assert_eq!(find(&[(a, &[pin(b)]), (b, &[pin(c)])]), None);
        assert_eq!(find(&[(a, &[Point::Pin(0, 9)])]), None);
    }

    #[test]
    fn a_long_chain_is_followed_without_recursion() {
        let chain = (0..100_000).map(|n| ((n, 1), (vec![Point::Pin(n + 1, 1)], Span::default())));
        let mut wires: Wires = chain.collect();
        assert_eq!(dead(&wires), None);
        wires.insert((100_000, 1), (vec![Point::Pin(0, 1)], Span::default()));
        assert_eq!(dead(&wires).map(|circle| circle.len()), Some(100_001));
    }
}
