//! The files for GitHub and GitLab, forms and workflows, are valid: read with a YAML reader, and compared
//! with the parts of their formats that are used here.

use standstill_xtask::{files, root};
use std::collections::BTreeSet;
use std::fs;
use yaml_rust2::{Yaml, YamlLoader};

fn yaml(text: &str, name: &str) -> Yaml {
    let mut documents = YamlLoader::load_from_str(text).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(documents.len(), 1, "{name}");
    documents.remove(0)
}

fn is_text(value: &Yaml) -> bool {
    value.as_str().is_some_and(|text| !text.is_empty())
}

#[test]
fn issue_forms_have_what_github_asks_for() {
    let folder = root().join(".github/ISSUE_TEMPLATE");
    let mut forms = 0;
    for path in files().iter().filter(|path| path.starts_with(&folder)) {
        let name = path.display().to_string();
        let form = yaml(&fs::read_to_string(path).unwrap(), &name);
        if path.ends_with("config.yml") {
            assert!(form["blank_issues_enabled"].as_bool().is_some(), "{name}");
            continue;
        }
        assert!(is_text(&form["name"]) && is_text(&form["description"]), "{name}");
        let body = form["body"].as_vec().unwrap_or_else(|| panic!("{name}: no body"));
        let mut ids = BTreeSet::new();
        for field in body {
            let attributes = &field["attributes"];
            match field["type"].as_str().unwrap_or_default() {
                "markdown" => assert!(is_text(&attributes["value"]), "{name}"),
                kind @ ("input" | "textarea" | "dropdown") => {
                    let id = field["id"]
                        .as_str()
                        .unwrap_or_else(|| panic!("{name}: a field without id"));
                    assert!(ids.insert(id), "{name}: {id} twice");
                    assert!(is_text(&attributes["label"]), "{name}: {id} has no label");
                    let options = attributes["options"].as_vec();
                    assert_eq!(
                        kind == "dropdown",
                        options.is_some_and(|all| !all.is_empty()),
                        "{name}: {id}"
                    );
                    let required = &field["validations"]["required"];
                    assert!(
                        required.is_badvalue() || required.as_bool().is_some(),
                        "{name}: {id}"
                    );
                }
                other => panic!("{name}: a field of type {other:?}"),
            }
        }
        assert!(!ids.is_empty(), "{name}: nothing to fill in");
        forms += 1;
    }
    assert!(forms >= 4, "{forms} forms");
}

/// A test of the command line checks the commands in it.
#[test]
fn the_example_workflow_is_one_and_the_guide_shows_it() {
    let name = "docs/how-to/standstill.yml";
    let text = fs::read_to_string(root().join(name)).unwrap();
    let workflow = yaml(&text, name);
    assert!(
        !workflow["on"].is_badvalue() && !workflow["jobs"].is_badvalue(),
        "{name}"
    );
    for (_, job) in workflow["jobs"].as_hash().unwrap() {
        assert!(is_text(&job["runs-on"]), "{name}");
        let steps = job["steps"].as_vec().unwrap();
        assert!(
            steps
                .iter()
                .all(|step| is_text(&step["uses"]) != is_text(&step["run"])),
            "{name}"
        );
        let tests = |step: &&Yaml| {
            step["run"]
                .as_str()
                .is_some_and(|run| run.starts_with("standstill test "))
        };
        assert_eq!(steps.iter().filter(tests).count(), 1, "{name}");
    }
    let guide = fs::read_to_string(root().join("docs/how-to/ci.md")).unwrap();
    let shown: Vec<_> = guide
        .split("```yaml\n")
        .skip(1)
        .filter_map(|rest| rest.split("```").next())
        .collect();
    assert_eq!(shown[0], text, "docs/how-to/ci.md does not show {name}");
    let template = fs::read_to_string(root().join("docs/how-to/standstill.gitlab-ci.yml")).unwrap();
    assert!(
        shown.contains(&template.as_str()),
        "docs/how-to/ci.md does not show the template for GitLab"
    );
    for text in shown {
        yaml(text, "docs/how-to/ci.md");
    }
}
