//! Random mutations of texts that consist of words, signs and lines.

use crate::random::Random;

/// Replacements of numbers.
const NUMBERS: [&str; 16] = [
    "0", "-1", "1", "2", "3", "-0", "0.5", "1e1", "1e30", "1e400", "nan", "-inf", "x", "7", "-2",
    "65536",
];

/// Splits a text into words and the characters between them.
fn split(text: &str) -> Vec<&str> {
    let is_word = |c: char| c.is_alphanumeric() || "._-+".contains(c);
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let kind = is_word(first);
        let end = rest.find(|c| is_word(c) != kind).unwrap_or(rest.len());
        // Each sign is a part of its own.
        let end = if kind { end } else { first.len_utf8() };
        pieces.push(&rest[..end]);
        rest = &rest[end..];
    }
    pieces
}

fn change(text: &str, random: &mut Random) -> String {
    let (one, other) = (random.bits() as usize, random.bits() as usize);
    let mut lines: Vec<&str> = text.split_inclusive('\n').collect();
    let count = lines.len().max(1);
    let (line, second) = (one % count, other % count);
    let mut pieces = split(text);
    let is_word = |piece: &&str| piece.starts_with(|c: char| c.is_alphanumeric() || c == '-');
    let words: Vec<usize> = (0..pieces.len()).filter(|&k| is_word(&pieces[k])).collect();
    if words.is_empty() || lines.is_empty() {
        return text.to_owned();
    }
    let (word, next) = (words[one % words.len()], words[other % words.len()]);
    let numbers: Vec<usize> = words
        .iter()
        .copied()
        .filter(|&k| pieces[k].parse::<f64>().is_ok())
        .collect();
    let number = numbers
        .get(one % numbers.len().max(1))
        .copied()
        .unwrap_or(word);
    match random.below(14) {
        0..=3 => pieces[number] = NUMBERS[random.below(NUMBERS.len())],
        4 => pieces[word] = pieces[next],
        5 => pieces.swap(word, next),
        6 => pieces[word] = "",
        7 => {
            pieces.insert(word, " ");
            pieces.insert(word, pieces[word + 1]);
        }
        8 => drop(lines.remove(line)),
        9 => lines.insert(line, lines[second]),
        10 => lines.swap(line, (line + 1) % count),
        11 => {
            let upper = pieces[word].to_uppercase();
            let changed_case = if upper == pieces[word] {
                upper.to_lowercase()
            } else {
                upper
            };
            pieces[word] = &changed_case;
            return pieces.concat();
        }
        12 => pieces.truncate(word),
        _ => return text.replace('\n', ["\r\n", "\n\n", " \n\t", "\r"][one % 4]),
    }
    if lines.concat() == text {
        pieces.concat()
    } else {
        lines.concat()
    }
}

/// `count` texts, each with one to three random changes.
pub fn changed(text: &str, count: usize, random: &mut Random) -> Vec<String> {
    let each = (0..count).map(|_| {
        let mut text_copy = text.to_owned();
        for _ in 0..=random.below(3) {
            text_copy = change(&text_copy, random);
        }
        text_copy
    });
    each.collect()
}
