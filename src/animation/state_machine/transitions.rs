//! Choice and timing of transitions.

use super::condition::{Condition, Transition};
use super::definition::Interruption;
use super::machine::StateMachine;
use super::playing::{Fade, MOMENT, Origin, Playing, Progress};
use super::run::StateMachineRun;
use crate::animation::SizeMismatch;

/// Transition whose conditions hold.
struct Open<'a> {
    index: usize,
    /// Source state.
    left: &'a Playing,
    /// Seconds until it may be taken.
    wait: f64,
}

impl StateMachineRun {
    /// Takes the transitions of the current time, none twice and at most `most`, so that cycles end. Returns their
    /// number.
    pub(super) fn take_all(
        &mut self,
        machine: &StateMachine,
        most: usize,
    ) -> Result<usize, SizeMismatch> {
        self.taken.clear();
        while self.taken.len() < most {
            let due = |open: &Open| open.wait <= MOMENT && !self.taken.contains(&open.index);
            let Some(Open { index, left, .. }) = self.open(machine).find(due) else {
                break;
            };
            let transition = &machine.transitions[index];
            // The source state may be the one left by an interrupted cross-fade.
            let entered = match transition.in_step {
                true => left.start_in_step(machine, transition.to),
                false => Playing::start(machine, transition.to),
            };
            self.taken.push(index);
            self.take(transition, entered)?;
        }
        Ok(self.taken.len())
    }

    /// Seconds until the cross-fade ends or another transition becomes possible; infinite if neither happens.
    pub(super) fn until_change(&self, machine: &StateMachine) -> f64 {
        let fade = self.fade.as_ref().map(|fade| fade.progress.left());
        let waits = self.open(machine).map(|open| open.wait);
        let waits = waits.filter(|wait| *wait > MOMENT);
        waits.chain(fade).fold(f64::INFINITY, f64::min)
    }

    /// Transitions whose conditions hold, in order of precedence.
    fn open<'a>(&'a self, machine: &'a StateMachine) -> impl Iterator<Item = Open<'a>> + 'a {
        let sources = self.sources().into_iter().flatten();
        sources.flat_map(move |playing| {
            let transitions = machine.transitions.iter().enumerate();
            transitions
                .filter(move |(_, own)| self.leads_away(playing, own))
                .filter(|(_, own)| own.conditions.iter().all(|c| self.holds(*c)))
                .map(move |(index, own)| Open {
                    index,
                    left: playing,
                    wait: self.wait(machine, playing, own),
                })
        })
    }

    /// States whose transitions are active.
    fn sources(&self) -> [Option<&Playing>; 2] {
        let Some(fade) = &self.fade else {
            return [Some(&self.current), None];
        };
        match fade.interruption {
            Interruption::Never => [None, None],
            Interruption::Source => [fade.leaving(), None],
            Interruption::Target => [Some(&self.current), None],
            Interruption::Either => [fade.leaving(), Some(&self.current)],
        }
    }

    /// Returns true if a transition leads from a state to another one than the current target.
    fn leads_away(&self, playing: &Playing, transition: &Transition) -> bool {
        let going = self.current.state;
        match transition.from {
            Some(from) => from == playing.state && (self.fade.is_none() || transition.to != going),
            None => transition.to != going,
        }
    }

    fn take(&mut self, transition: &Transition, entered: Playing) -> Result<(), SizeMismatch> {
        for condition in &transition.conditions {
            if let Condition::Triggered { parameter } = condition {
                self.triggered[*parameter] = false;
            }
        }
        let fades = transition.seconds > 0.0;
        let broken = self.fade.is_some();
        if broken && fades {
            // After an interruption the next cross-fade starts from the current pose.
            self.show()?;
        }
        self.fade = None;
        let left = std::mem::replace(&mut self.current, entered);
        self.fade = fades.then(|| Fade {
            from: match broken {
                true => Origin::Still(self.pose.clone()),
                false => Origin::State(left),
            },
            progress: Progress::new(transition.seconds, transition.easing),
            interruption: transition.interruption,
        });
        Ok(())
    }

    /// Seconds until a state has played as long as a transition requires.
    fn wait(&self, machine: &StateMachine, playing: &Playing, transition: &Transition) -> f64 {
        let state = &machine.states[playing.state];
        let mix = state.motion.mix(&self.values);
        let played = transition
            .after
            .map(|times| playing.until_played(state, mix, times));
        let stayed = transition
            .after_seconds
            .map(|seconds| seconds - playing.seconds);
        played.into_iter().chain(stayed).fold(0.0, f64::max)
    }
}
