//! Which lights shine: solo and mute, as on a mixing desk.

/// Of each light whether it is muted or played alone, and which one is chosen.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mix {
    muted: Vec<bool>,
    solo: Vec<bool>,
    /// The light that keys and debug views are about.
    pub chosen: Option<usize>,
}

impl Mix {
    /// All lights shine, none is chosen.
    pub fn new(lights: usize) -> Self {
        Self {
            muted: vec![false; lights],
            solo: vec![false; lights],
            chosen: None,
        }
    }

    /// Whether it is muted itself.
    pub fn is_muted(&self, light: usize) -> bool {
        self.muted[light]
    }

    /// Whether it is one of those that play alone.
    pub fn is_solo(&self, light: usize) -> bool {
        self.solo[light]
    }

    /// Mutes a light, or no longer.
    pub fn toggle_mute(&mut self, light: usize) {
        self.muted[light] ^= true;
    }

    /// Lets a light play alone, or no longer; several may, together.
    pub fn toggle_solo(&mut self, light: usize) {
        self.solo[light] ^= true;
    }

    /// The lights that are silent: muted, or not among those that play alone.
    pub fn silent(&self) -> Vec<usize> {
        let any_solo = self.solo.contains(&true);
        let is_silent = |light: &usize| self.muted[*light] || any_solo && !self.solo[*light];
        (0..self.muted.len()).filter(is_silent).collect()
    }

    /// All lights shine again.
    pub fn clear(&mut self) {
        self.muted.fill(false);
        self.solo.fill(false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solo_silences_the_others_and_mute_wins() {
        let mut mix = Mix::new(4);
        assert!(mix.silent().is_empty());
        mix.toggle_mute(0);
        assert_eq!(mix.silent(), [0]);
        mix.toggle_solo(1);
        mix.toggle_solo(2);
        assert_eq!(mix.silent(), [0, 3]);
        mix.toggle_mute(2);
        assert_eq!(mix.silent(), [0, 2, 3]);
        mix.toggle_solo(1);
        mix.toggle_solo(2);
        assert_eq!(mix.silent(), [0, 2]);
        mix.clear();
        assert!(mix.silent().is_empty());
    }
}
