//! Circles of wires.
//!
//! A wire reads its source as it stands when its block is called, so a circle through a block's outputs is
//! an ordinary feedback that takes a scan. A circle of inputs alone has no source at all: its value would be
//! the initial one for ever.

use crate::error::{Code, Diagnostic};
use crate::model::{Instance, Point, Span, Wire};
use std::collections::{BTreeMap, BTreeSet};

/// An input pin: instance and pin index.
type Place = (usize, usize);

/// The wired inputs, what they read, and the place of their name.
pub(super) type Wires = BTreeMap<Place, (Vec<Place>, Span)>;

/// The pins a wire reads.
pub(super) fn sources(wire: &Wire) -> Vec<Place> {
    let points: &[Point] = match wire {
        Wire::From(point) | Wire::Not(point) => std::slice::from_ref(point),
        Wire::Any(points) | Wire::All(points) => points,
    };
    let pin = |point: &Point| match point {
        Point::Pin(instance, pin) => Some((*instance, *pin)),
        Point::Input(_) => None,
    };
    points.iter().filter_map(pin).collect()
}

/// The first circle of inputs, in the direction of reading. Depth-first without recursion, so that a long
/// chain cannot overflow the stack; every wire is followed once.
pub(super) fn first_cycle(wires: &Wires) -> Option<Vec<Place>> {
    let mut finished: BTreeSet<Place> = BTreeSet::new();
    for start in wires.keys() {
        // The way from `start`, each with the number of sources already followed.
        let mut way: Vec<(Place, usize)> = vec![(*start, 0)];
        let mut on_way = BTreeSet::from([*start]);
        while let Some((place, followed)) = way.last_mut() {
            let next = wires
                .get(place)
                .and_then(|(sources, _)| sources.get(*followed))
                .copied();
            *followed += 1;
            match next {
                None => {
                    on_way.remove(place);
                    finished.insert(*place);
                    way.pop();
                }
                Some(next) if on_way.contains(&next) => {
                    return Some(
                        way.iter()
                            .map(|(place, _)| *place)
                            .skip_while(|place| *place != next)
                            .collect(),
                    );
                }
                Some(next) if wires.contains_key(&next) && !finished.contains(&next) => {
                    on_way.insert(next);
                    way.push((next, 0));
                }
                Some(_) => {}
            }
        }
    }
    None
}

/// The message for a circle.
pub(super) fn cycle_error(cycle: &[Place], wires: &Wires, blocks: &[Instance]) -> Diagnostic {
    let name = |place: &Place| {
        let block = blocks.get(place.0);
        let pin = block.and_then(|block| block.block.pins().nth(place.1));
        format!(
            "{}.{}",
            block.map_or("", |block| &block.name),
            pin.map_or("", |pin| pin.name)
        )
    };
    let names: Vec<String> = cycle.iter().chain(cycle.first()).map(name).collect();
    let span = |place: Option<&Place>| place.and_then(|place| wires.get(place)).map(|(_, span)| *span);
    let message = format!("inputs are wired in a circle: {}", names.join(" <- "));
    let diagnostic = Diagnostic::new(Code::WireCycle, span(cycle.first()).unwrap_or_default(), message)
        .help("none of them ever gets a value; wire one of them from an output or an input variable");
    match cycle.get(1) {
        Some(second) => diagnostic.related(span(Some(second)).unwrap_or_default(), "read by it"),
        None => diagnostic,
    }
}
