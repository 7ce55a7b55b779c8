//! Joints that loads close to next to nothing.

use crate::one_answer::{assert_one_answer, solved};

/// Most iterations of the step.
const MOST: u64 = 30;

/// A load of forty thousand times `K_n b_0` leaves a logarithmic joint an aperture of `e^-200 b_0`:
/// far stiffer than a matrix bears where walls meet at an angle.
#[test]
fn joints_that_are_all_but_closed_are_as_easy_as_contact() {
    let answers = solved("closed_wedge.toml", &[]);
    assert_one_answer(&answers, &["f", "g"]);
    for said in &answers {
        let iterations = said["steps"][0]["newton_iterations"].as_u64();
        assert!(
            iterations.is_some_and(|count| count <= MOST),
            "{iterations:?}"
        );
    }
}
