//! Crowds: many characters with one armature.

mod character;

pub use character::{Character, PlayingClip};

use super::{Armature, Limb, Pose, SizeMismatch};

/// Least number of characters per parallel task, which amortises the cost of scheduling.
#[cfg(feature = "rayon")]
const MIN_CHARACTERS_PER_TASK: usize = 8;

/// Characters that share an armature and limbs. A frame samples and blends the clips of each character, solves its
/// limbs and computes its model transforms.
///
/// ```
/// use std::sync::Arc;
///
/// use kinopt::animation::{Armature, ArmatureBone, Clip, Crowd, LocalTransform, PlayingClip};
///
/// let hips = ArmatureBone { name: "hips".into(), parent: None, rest: LocalTransform::IDENTITY };
/// let armature = Armature::new(vec![hips], Vec::new())?;
/// let walk = Arc::new(Clip::builder("walk", &armature).build());
///
/// let mut crowd = Crowd::new(armature, Vec::new());
/// for number in 0..100 {
///     let mut walking = PlayingClip::new(Arc::clone(&walk));
///     walking.playhead.speed = 1.0 + 0.01 * f64::from(number);
///     crowd.add(vec![walking])?;
/// }
/// crowd.advance(1.0 / 60.0)?;
/// assert_eq!(crowd.characters()[7].model_from_bone().len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Crowd {
    armature: Armature,
    limbs: Vec<Limb>,
    characters: Vec<Character>,
    /// Buffer for samples of clips after the first.
    other: Pose,
}

impl Crowd {
    /// A crowd without characters. The limbs belong to the armature; each character has a goal for each limb.
    #[must_use]
    pub fn new(armature: Armature, limbs: Vec<Limb>) -> Self {
        Self {
            other: armature.rest().clone(),
            characters: Vec::new(),
            armature,
            limbs,
        }
    }

    /// Adds a character that plays these clips. It is in the rest pose until the next frame. The goals of its limbs
    /// have weight 0.
    ///
    /// # Errors
    /// A clip is of another armature's size.
    pub fn add(&mut self, clips: Vec<PlayingClip>) -> Result<&mut Character, SizeMismatch> {
        for playing in &clips {
            playing.check(&self.armature)?;
        }
        let character = Character::new(&self.armature, self.limbs.len(), clips);
        self.characters.push(character);
        let last = self.characters.len() - 1;
        Ok(&mut self.characters[last])
    }

    /// Armature of the characters.
    #[must_use]
    pub fn armature(&self) -> &Armature {
        &self.armature
    }

    /// The characters, in insertion order.
    #[must_use]
    pub fn characters(&self) -> &[Character] {
        &self.characters
    }

    /// Mutable access to the characters' clips and goals.
    #[must_use]
    pub fn characters_mut(&mut self) -> &mut [Character] {
        &mut self.characters
    }

    /// Advances all characters by `seconds`. Allocates nothing after the first frame.
    ///
    /// # Errors
    /// A character was swapped with one of a crowd whose armature has another size.
    pub fn advance(&mut self, seconds: f64) -> Result<(), SizeMismatch> {
        self.characters.iter_mut().try_for_each(|character| {
            character.advance(&self.armature, &self.limbs, seconds, &mut self.other)
        })
    }

    /// [`advance`](Self::advance) on the threads of the current rayon pool. The result is bitwise equal.
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    #[cfg(feature = "rayon")]
    pub fn advance_parallel(&mut self, seconds: f64) -> Result<(), SizeMismatch> {
        use rayon::prelude::*;
        let (armature, limbs) = (&self.armature, &self.limbs);
        self.characters
            .par_iter_mut()
            .with_min_len(MIN_CHARACTERS_PER_TASK)
            .try_for_each_init(
                || armature.rest().clone(),
                |other, character| character.advance(armature, limbs, seconds, other),
            )
    }
}
