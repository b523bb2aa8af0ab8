//! Choice and timing of transitions.

use super::condition::{Condition, Transition};
use super::definition::Interruption;
use super::machine::StateMachine;
use super::playing::{Fade, FadeProgress, Origin, Playing, TIME_TOLERANCE};
use super::run::StateMachineRun;
use crate::animation::SizeMismatch;

/// Transition whose conditions hold.
struct ReadyTransition<'a> {
    index: usize,
    /// Source state.
    source: &'a Playing,
    /// Seconds until it may be taken.
    wait: f64,
}

impl StateMachineRun {
    /// Takes the transitions of the current time, none twice and at most `max_taken`, so that cycles end. Returns their
    /// number.
    pub(super) fn take_transitions(
        &mut self,
        machine: &StateMachine,
        max_taken: usize,
    ) -> Result<usize, SizeMismatch> {
        self.taken.clear();
        while self.taken.len() < max_taken {
            let due = |ready: &ReadyTransition| {
                ready.wait <= TIME_TOLERANCE && !self.taken.contains(&ready.index)
            };
            let Some(ReadyTransition { index, source, .. }) =
                self.ready_transitions(machine).find(due)
            else {
                break;
            };
            let transition = &machine.transitions[index];
            // The source state may be the one left by an interrupted cross-fade.
            let entered = match transition.in_step {
                true => source.start_in_step(machine, transition.to),
                false => Playing::start(machine, transition.to),
            };
            self.taken.push(index);
            self.start_transition(transition, entered)?;
        }
        Ok(self.taken.len())
    }

    /// Seconds until the cross-fade ends or another transition becomes possible; infinite if neither happens.
    pub(super) fn seconds_until_change(&self, machine: &StateMachine) -> f64 {
        let fade = self.fade.as_ref().map(|fade| fade.progress.remaining());
        let waits = self.ready_transitions(machine).map(|ready| ready.wait);
        let waits = waits.filter(|wait| *wait > TIME_TOLERANCE);
        waits.chain(fade).fold(f64::INFINITY, f64::min)
    }

    /// Transitions whose conditions hold, in order of precedence.
    fn ready_transitions<'a>(
        &'a self,
        machine: &'a StateMachine,
    ) -> impl Iterator<Item = ReadyTransition<'a>> + 'a {
        let sources = self.sources().into_iter().flatten();
        sources.flat_map(move |playing| {
            let transitions = machine.transitions.iter().enumerate();
            transitions
                .filter(move |(_, transition)| self.leads_away(playing, transition))
                .filter(|(_, transition)| {
                    transition.conditions.iter().all(|c| self.is_satisfied(*c))
                })
                .map(move |(index, transition)| ReadyTransition {
                    index,
                    source: playing,
                    wait: self.wait(machine, playing, transition),
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
        let target_state = self.current.state;
        match transition.from {
            Some(from) => {
                from == playing.state && (self.fade.is_none() || transition.to != target_state)
            }
            None => transition.to != target_state,
        }
    }

    fn start_transition(
        &mut self,
        transition: &Transition,
        entered: Playing,
    ) -> Result<(), SizeMismatch> {
        for condition in &transition.conditions {
            if let Condition::Triggered { parameter } = condition {
                self.triggered[*parameter] = false;
            }
        }
        let has_fade = transition.seconds > 0.0;
        let is_interrupted = self.fade.is_some();
        if is_interrupted && has_fade {
            // After an interruption the next cross-fade starts from the current pose.
            self.update_pose()?;
        }
        self.fade = None;
        let source = std::mem::replace(&mut self.current, entered);
        self.fade = has_fade.then(|| Fade {
            from: match is_interrupted {
                true => Origin::Still(self.pose.clone()),
                false => Origin::State(source),
            },
            progress: FadeProgress::new(transition.seconds, transition.easing),
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
            .map(|times| playing.seconds_until_played(state, mix, times));
        let remaining = transition
            .after_seconds
            .map(|seconds| seconds - playing.seconds);
        played.into_iter().chain(remaining).fold(0.0, f64::max)
    }
}
