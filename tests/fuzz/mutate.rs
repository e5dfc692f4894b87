//! Simple mutations of files: bits, bytes, numbers, cuts and splices, all from one seed.

/// SplitMix64 (Steele, Lea and Flood 2014).
pub(crate) struct Mutator(u64);

/// Words that formats trip over.
const WORDS: [&[u8]; 12] = [
    b"0",
    b"-1",
    b"1e38",
    b"1e39",
    b"-0.0",
    b"null",
    b"[]",
    b"4294967295",
    b"18446744073709551616",
    b"\xFF\xFF\xFF\xFF",
    b"\0\0\x80\x7F",
    b"\0\0\xC0\x7F",
];

impl Mutator {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    /// One to four changes to one of `seeds`.
    pub(crate) fn mutate(&mut self, seeds: &[&[u8]]) -> Vec<u8> {
        let mut bytes = seeds[self.below(seeds.len())].to_vec();
        for _ in 0..1 + self.below(4) {
            self.change(&mut bytes, seeds);
        }
        bytes
    }

    fn change(&mut self, bytes: &mut Vec<u8>, seeds: &[&[u8]]) {
        let at = self.below(bytes.len());
        match self.below(6) {
            _ if bytes.is_empty() => bytes.push(b'0'),
            0 => bytes[at] ^= 1 << self.below(8),
            1 => bytes[at] = self.next() as u8,
            2 => self.number(bytes, at),
            3 => bytes.truncate(at),
            4 => {
                let end = bytes.len().min(at + self.below(16));
                let part = bytes[at..end].to_vec();
                bytes.splice(at..at, part);
            }
            _ => {
                let other = seeds[self.below(seeds.len())];
                let from = self.below(other.len());
                let end = other.len().min(from + self.below(64));
                let over = bytes.len().min(at + self.below(64));
                bytes.splice(at..over, other[from..end].iter().copied());
            }
        }
    }

    /// Replaces the digits after `at`, or four bytes there.
    fn number(&mut self, bytes: &mut Vec<u8>, at: usize) {
        let digit = |b: &u8| b.is_ascii_digit();
        let start = bytes[at..].iter().position(digit).map_or(at, |n| at + n);
        let length = bytes[start..].iter().take_while(|b| digit(b)).count();
        let end = bytes
            .len()
            .min(start + if length == 0 { 4 } else { length });
        let word = WORDS[self.below(WORDS.len())];
        bytes.splice(start..end, word.iter().copied());
    }
}
