//! The refinement of a found minimum, for models without noise.
//!
//! First the quasi-Newton descent ([`super::local`]), which is unbeaten where the misfit is smooth; when it can go no
//! further, covariance matrix adaptation ([`super::cma_es`]) from its end with a small step, which does not mind the
//! edges that Σ|d| and max|d| have at their minimum.

use super::cma_es::{self, CmaEs};
use super::constraint::Domain;
use super::local::Local;
use super::{Optimiser, Stop, Trial};

/// First step of the covariance matrix adaptation, in ranges.
const STEP: f64 = 0.01;

/// The state of a refinement.
pub struct Polish {
    domain: Domain,
    seed: u64,
    descent: Local,
    adaptation: Option<CmaEs>,
}

impl Polish {
    /// A refinement from an evaluated point of the unit box.
    pub fn new(domain: &Domain, point: &[f64], misfit: f64, seed: u64) -> Self {
        Self { domain: domain.clone(), seed, descent: Local::new(domain, point, misfit), adaptation: None }
    }
}

impl Optimiser for Polish {
    fn ask(&mut self) -> Vec<Vec<f64>> {
        match &mut self.adaptation {
            Some(adaptation) => adaptation.ask(),
            None => self.descent.ask(),
        }
    }

    fn tell(&mut self, trials: &[Trial]) {
        match &mut self.adaptation {
            Some(adaptation) => adaptation.tell(trials),
            None => {
                self.descent.tell(trials);
                if self.descent.stop().is_some() {
                    let settings = cma_es::Settings { step: STEP, restarts: 0, ..Default::default() };
                    let start = self.descent.best().0;
                    self.adaptation = Some(CmaEs::new(&settings, &self.domain, self.seed, start));
                }
            }
        }
    }

    fn stop(&self) -> Option<Stop> {
        self.adaptation.as_ref().and_then(Optimiser::stop)
    }
}
