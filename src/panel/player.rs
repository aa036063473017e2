//! The film's clock: which λ is shown.

/// What happens at the film's end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Repeat {
    /// It stops.
    #[default]
    Once,
    /// It begins again.
    Loop,
    /// It runs back.
    PingPong,
}

/// How λ follows time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Easing {
    /// Evenly.
    Linear,
    /// Slowly at both ends.
    #[default]
    Smooth,
}

/// Plays λ from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Player {
    /// Place in the film, 0..=1: time, of which [`lambda`](Self::lambda) is a function.
    time: f32,
    /// Whether it runs.
    pub is_playing: bool,
    backwards: bool,
    /// What happens at the end.
    pub repeat: Repeat,
    /// How λ follows time.
    pub easing: Easing,
    /// Films a second ÷ `SECONDS`: 1 takes four seconds.
    pub speed: f32,
}

/// Length of the film at speed 1.
pub const SECONDS: f32 = 4.0;

impl Default for Player {
    fn default() -> Self {
        Self {
            time: 1.0,
            is_playing: false,
            backwards: false,
            repeat: Repeat::Once,
            easing: Easing::Smooth,
            speed: 1.0,
        }
    }
}

impl Player {
    /// λ now.
    pub fn lambda(&self) -> f32 {
        match self.easing {
            Easing::Linear => self.time,
            Easing::Smooth => self.time * self.time * (3.0 - 2.0 * self.time),
        }
    }

    /// Goes to a λ and stops.
    pub fn scrub(&mut self, lambda: f32) {
        let lambda = lambda.clamp(0.0, 1.0);
        self.is_playing = false;
        self.time = match self.easing {
            Easing::Linear => lambda,
            // The inverse of t²(3 − 2t).
            Easing::Smooth => 0.5 - ((1.0 - 2.0 * lambda).clamp(-1.0, 1.0).asin() / 3.0).sin(),
        };
    }

    /// Changes how λ follows time; λ stays.
    pub fn set_easing(&mut self, easing: Easing) {
        let (lambda, was_playing) = (self.lambda(), self.is_playing);
        self.easing = easing;
        self.scrub(lambda);
        self.is_playing = was_playing;
    }

    /// Starts, or stops; from the beginning where it had come to the end.
    pub fn toggle(&mut self) {
        self.is_playing = !self.is_playing;
        if self.is_playing && self.time >= 1.0 {
            self.backwards = false;
            if self.repeat == Repeat::PingPong { self.backwards = true } else { self.time = 0.0 }
        }
    }

    /// Lets so many seconds pass.
    pub fn advance(&mut self, seconds: f32) {
        if !self.is_playing {
            return;
        }
        let step = seconds * self.speed / SECONDS;
        let time = if self.backwards { self.time - step } else { self.time + step };
        match self.repeat {
            Repeat::Once if time >= 1.0 => (self.time, self.is_playing) = (1.0, false),
            Repeat::Once => self.time = time.max(0.0),
            Repeat::Loop => self.time = time.rem_euclid(1.0),
            Repeat::PingPong => {
                // The way there and back is 2 long.
                let way = if self.backwards { 2.0 - time } else { time }.rem_euclid(2.0);
                self.backwards = way > 1.0;
                self.time = if self.backwards { 2.0 - way } else { way };
            }
        }
        if self.repeat != Repeat::PingPong {
            self.backwards = false;
        }
    }

    /// Goes to the next (or previous) of ascending λ and stops there.
    pub fn step(&mut self, keys: &[f32], forwards: bool) {
        let lambda = self.lambda();
        let next = if forwards {
            keys.iter().copied().find(|k| *k > lambda + 1.0e-3)
        } else {
            keys.iter().copied().rev().find(|k| *k < lambda - 1.0e-3)
        };
        if let Some(next) = next {
            self.scrub(next);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scrubbing_shows_the_lambda_asked_for() {
        for easing in [Easing::Linear, Easing::Smooth] {
            let mut player = Player { easing, ..Player::default() };
            for k in 0..=20 {
                let lambda = k as f32 / 20.0;
                player.scrub(lambda);
                assert!((player.lambda() - lambda).abs() < 1e-5, "{easing:?} {lambda} {}", player.lambda());
            }
            player.scrub(0.3);
            player.set_easing(Easing::Linear);
            assert!((player.lambda() - 0.3).abs() < 1e-5);
        }
    }

    #[test]
    fn each_way_to_repeat_ends_as_it_says() {
        let run = |repeat| {
            let mut player = Player { repeat, easing: Easing::Linear, ..Player::default() };
            player.scrub(0.0);
            player.toggle();
            let mut seen = Vec::new();
            for _ in 0..12 {
                player.advance(1.0);
                seen.push((player.lambda() * 4.0).round() as i32);
            }
            (seen, player.is_playing)
        };
        assert_eq!(run(Repeat::Once), (vec![1, 2, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4], false));
        assert_eq!(run(Repeat::Loop), (vec![1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0], true));
        assert_eq!(run(Repeat::PingPong), (vec![1, 2, 3, 4, 3, 2, 1, 0, 1, 2, 3, 4], true));
    }

    #[test]
    fn steps_go_from_key_to_key() {
        let mut player = Player::default();
        let keys = [0.0, 0.25, 0.5, 1.0];
        player.step(&keys, false);
        assert!((player.lambda() - 0.5).abs() < 1e-5);
        player.step(&keys, false);
        player.step(&keys, true);
        player.step(&keys, true);
        player.step(&keys, true);
        assert!((player.lambda() - 1.0).abs() < 1e-5);
    }
}
