//! Random mutations of JSON documents as trees, so that the results are valid JSON and mostly nearly correct.

use serde_json::{Value, json};

use crate::random::Random;

/// Replacement values, in addition to values from elsewhere in the document.
fn values() -> Vec<Value> {
    vec![
        json!(null),
        json!(true),
        json!(false),
        json!(0),
        json!(-0.0),
        json!(1),
        json!(-1),
        json!(2.5),
        json!(7),
        json!(255),
        json!(1e10),
        json!(-1e10),
        json!(1e30),
        json!(1e300),
        json!(u64::MAX),
        json!(""),
        json!(" "),
        json!("a/b"),
        json!("q\"\\\\\n\u{e9}"),
        json!([]),
        json!([0.0, 0.0, 0.0]),
        json!([0.5, 1]),
        json!({}),
    ]
}

fn children(value: &Value) -> Vec<&Value> {
    match value {
        Value::Array(list) => list.iter().collect(),
        Value::Object(map) => map.values().collect(),
        _ => Vec::new(),
    }
}

fn children_mut(value: &mut Value) -> Vec<&mut Value> {
    match value {
        Value::Array(list) => list.iter_mut().collect(),
        Value::Object(map) => map.values_mut().collect(),
        _ => Vec::new(),
    }
}

/// Descends to a random descendant, so that deep values are chosen as often as shallow ones.
fn below<'v>(value: &'v mut Value, random: &mut Random, deepest: bool) -> &'v mut Value {
    let count = children(value).len();
    if count == 0 || (!deepest && random.below(4) == 0) {
        return value;
    }
    let at = random.below(count);
    let inner = children_mut(value).swap_remove(at);
    below(inner, random, deepest)
}

/// Collects all keys of a document.
fn keys(value: &Value, all: &mut Vec<String>) {
    if let Value::Object(map) = value {
        all.extend(map.keys().cloned());
    }
    children(value)
        .into_iter()
        .for_each(|child| keys(child, all));
}

/// Random list or object of a document.
fn holder<'v>(root: &'v mut Value, random: &mut Random) -> &'v mut Value {
    let mut candidate = random.clone();
    let is_any = |value: &Value| !children(value).is_empty();
    for _ in 0..8 {
        let before = candidate.clone();
        if is_any(below(root, &mut candidate, false)) {
            *random = candidate;
            return below(root, &mut before.clone(), false);
        }
    }
    root
}

/// Applies one random change to a document.
pub fn change(root: &mut Value, random: &mut Random) {
    let other_value = below(&mut root.clone(), random, false).clone();
    let mut known_keys = Vec::new();
    keys(root, &mut known_keys);
    let (one, other) = (random.bits() as usize, random.bits() as usize);
    match random.below(12) {
        0..=2 => {
            let all = values();
            *below(root, random, true) = all[one % all.len()].clone();
        }
        3 => *below(root, random, true) = other_value,
        4 | 5 => {
            let value = below(root, random, true);
            if let Some(number) = value.as_f64() {
                let by = [2.0, -1.0, 0.5, 1.001, 1e-9, 1e6][one % 6];
                *value = json!(number * by);
            } else if let Some(text) = value.as_str() {
                *value = match one % 4 {
                    0 => json!(format!("{text}{text}")),
                    1 => json!(text.to_uppercase()),
                    2 => json!(text.get(1..).unwrap_or("x")),
                    _ => json!(known_keys[other % known_keys.len().max(1)]),
                };
            }
        }
        6 | 7 => match holder(root, random) {
            Value::Array(list) => drop(list.remove(one % list.len())),
            Value::Object(map) => {
                let key = map.keys().nth(one % map.len()).cloned();
                key.and_then(|key| map.remove(&key));
            }
            _ => {}
        },
        8 | 9 => match holder(root, random) {
            Value::Array(list) => {
                let copy = list[one % list.len()].clone();
                list.insert(other % (list.len() + 1), copy);
            }
            Value::Object(map) => {
                let key = known_keys[one % known_keys.len()].clone();
                map.insert(key, other_value);
            }
            _ => {}
        },
        _ => match holder(root, random) {
            Value::Array(list) => {
                let count = list.len();
                list.swap(one % count, other % count);
            }
            Value::Object(map) => {
                let names: Vec<String> = map.keys().cloned().collect();
                let (a, b) = (&names[one % names.len()], &names[other % names.len()]);
                if let (Some(first), Some(second)) = (map.get(a).cloned(), map.get(b).cloned()) {
                    map.insert(a.clone(), second);
                    map.insert(b.clone(), first);
                }
            }
            _ => {}
        },
    }
}

/// `count` documents, each with one to three random changes.
pub fn changed(text: &str, count: usize, random: &mut Random) -> Vec<String> {
    let original: Value = serde_json::from_str(text).unwrap();
    let each = (0..count).map(|number| {
        let mut document = original.clone();
        for _ in 0..=random.below(3) {
            change(&mut document, random);
        }
        // Compact or pretty-printed.
        match number % 2 {
            0 => document.to_string(),
            _ => serde_json::to_string_pretty(&document).unwrap(),
        }
    });
    each.collect()
}
