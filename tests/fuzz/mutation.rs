//! Changes of bytes that readers may find hard.

use crate::random::Random;

/// Numbers at which readers stumble.
const NUMBERS: [&str; 32] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "7",
    "1e-9",
    "-1e-300",
    "5e-324",
    "1e300",
    "1.7976931348623157e308",
    "1e309",
    "-1e400",
    "nan",
    "inf",
    "-infinity",
    "255",
    "256",
    "65536",
    "2147483647",
    "2147483648",
    "4294967295",
    "4294967296",
    "18446744073709551616",
    "-2147483649",
    "0.1",
    "360",
    "1.5e",
    "1.2.3",
    "--1",
    "0x10",
];

/// The same in binary.
const WORDS: [u32; 10] = [
    0,
    1,
    3,
    0xff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7f80_0000,
    0x7fc0_0000,
    0x7f7f_ffff,
];

/// One of the seeds with some changes; sometimes none.
pub(crate) fn mutated(seeds: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut bytes = seeds[random.below(seeds.len())].clone();
    let most = random.one_of(&[0, 1, 1, 2, 3, 8]);
    for _ in 0..most {
        if bytes.is_empty() {
            break;
        }
        change(&mut bytes, seeds, random);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, seeds: &[Vec<u8>], random: &mut Random) {
    match random.below(12) {
        0 => {
            let place = random.below(bytes.len());
            bytes[place] ^= 1 << random.below(8);
        }
        1 => {
            let place = random.below(bytes.len());
            bytes[place] = random.one_of(b"\0\n\r\t \"'<>&;,.#/-+eE0123456789\xff\x80{}[]()%");
        }
        2 => {
            let range = range(bytes.len(), random);
            bytes.drain(range);
        }
        3 => {
            let copy = bytes[range(bytes.len(), random)].to_vec();
            let place = random.below(bytes.len());
            bytes.splice(place..place, copy);
        }
        4 => {
            let other = &seeds[random.below(seeds.len())];
            if !other.is_empty() {
                let part = other[range(other.len(), random)].to_vec();
                let place = range(bytes.len(), random);
                bytes.splice(place, part);
            }
        }
        5 => {
            let word = random.one_of(&WORDS);
            let word = if random.chance(0.5) {
                word.to_le_bytes()
            } else {
                word.to_be_bytes()
            };
            let place = random.below(bytes.len());
            for (byte, new) in bytes[place..].iter_mut().zip(word) {
                *byte = new;
            }
        }
        6 => bytes.truncate(random.below(bytes.len())),
        7 => {
            let (mut lines, chosen) = line(bytes, random);
            lines.remove(chosen);
            *bytes = lines.concat();
        }
        8 => {
            let (mut lines, chosen) = line(bytes, random);
            let copy = lines[random.below(lines.len())].clone();
            lines.insert(chosen, copy);
            *bytes = lines.concat();
        }
        // Most files are numbers for the most part.
        _ => change_number(bytes, random),
    }
}

/// A range, more often a short one.
fn range(length: usize, random: &mut Random) -> std::ops::Range<usize> {
    let start = random.below(length);
    let most = random.one_of(&[1, 4, 16, 64, length]);
    start..length.min(start + 1 + random.below(most))
}

/// The lines with their ends, and the number of one of them.
fn line(bytes: &[u8], random: &mut Random) -> (Vec<Vec<u8>>, usize) {
    let lines: Vec<Vec<u8>> = bytes
        .split_inclusive(|&byte| byte == b'\n')
        .map(<[u8]>::to_vec)
        .collect();
    let chosen = random.below(lines.len());
    (lines, chosen)
}

/// Replaces a number that stands as text: by a hard one, or by another one of the file.
fn change_number(bytes: &mut Vec<u8>, random: &mut Random) {
    let is_part = |byte: u8| byte.is_ascii_digit() || b"+-.".contains(&byte);
    let mut numbers = Vec::new();
    let mut start = None;
    for place in 0..=bytes.len() {
        let here = bytes.get(place).is_some_and(|&byte| is_part(byte));
        match (start, here) {
            (None, true) => start = Some(place),
            (Some(from), false) => {
                numbers.push(from..place);
                start = None;
            }
            _ => {}
        }
    }
    if numbers.is_empty() {
        return;
    }
    let new = if random.chance(0.6) {
        random.one_of(&NUMBERS).as_bytes().to_vec()
    } else {
        bytes[numbers[random.below(numbers.len())].clone()].to_vec()
    };
    let place = numbers[random.below(numbers.len())].clone();
    bytes.splice(place, new);
}
