//! `umbrage stress`, as scripts run it.

mod common;

use common::{assert_keys, json, refused};

#[test]
fn a_campaign_without_pictures_needs_no_adapter_and_counts_by_family() {
    let run = |threads| {
        let line = ["stress", "--cases", "51", "--render", "0", "--seed", "4"];
        json(0, &[&line[..], &["--threads", threads]].concat())
    };
    let report = run("1");
    assert_keys(
        &report,
        "cases rendered samples wrong ambiguous closed families seed tolerance not_drawn failures",
    );
    assert_eq!(report["cases"], 51);
    assert_eq!(report["rendered"], 0);
    assert_eq!(report["wrong"], 0);
    assert_eq!(report["closed"], true);
    let families = report["families"].as_array().unwrap();
    assert!(families.iter().all(|family| family["cases"] == 3));
    assert_eq!(report, run("3"), "results hang on the number of threads");
}

#[test]
fn one_case_is_tried_again_by_its_name() {
    let line = ["stress", "--case", "lattice:2a", "--render", "0"];
    let report = json(0, &line);
    assert_eq!(report["cases"], 1);
    assert_eq!(report["families"][0]["name"], "lattice");
    assert_eq!(report, json(0, &line));
}

#[test]
fn families_and_cases_that_there_are_not_are_refused_with_those_there_are() {
    for line in [
        ["stress", "--family", "cubism"],
        ["stress", "--case", "lattice:xyz"],
    ] {
        let errors = refused(2, &line);
        assert!(errors.contains("slivers"), "{errors}");
    }
}
