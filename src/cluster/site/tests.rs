use super::*;

#[test]
fn a_site_file_is_read_with_its_units_and_overrides() {
    let site = Site::parse(
        "partition = \"short\"\nworkers = 40\nmemory = \"1.5 GB\"\ntime = \"4 h\"\nsetup = [\"module load gcc\"]\n\
         [stage.specimen]\nmemory = \"8 GB\"\n[stage.quick]\nhere = true\n",
    )
    .unwrap();
    let (needs, specimen) = (site.needs("rows"), site.needs("specimen"));
    assert_eq!((needs.memory, needs.time.map(|time| time.get())), (Some(Memory(1500)), Some(14_400.0)));
    assert_eq!((specimen.memory, specimen.partition.as_deref()), (Some(Memory(8000)), Some("short")));
    assert_eq!(specimen.again().memory, Some(Memory(16_000)));
    assert!(site.sends("rows", true) && !site.sends("rows", false) && !site.sends("quick", true));
}

#[test]
fn every_fault_of_a_site_file_is_told_with_its_remedy() {
    for (text, wanted) in [
        ("wokers = 3", "unknown field `wokers`"),
        ("memory = \"2\"", "write a number and MB, GB or TB"),
        ("memory = \"-2 GB\"", "write a number and MB, GB or TB"),
        ("time = 3600", "with its unit"),
        ("workers = 0", "`workers` is 0; give a number from 1"),
        ("time = \"5 s\"", "give at least \"1 min\""),
        ("scheduler = \"pbs\"", "`slurm` or `commands`"),
        ("scheduler = \"commands\"", "needs a table `[commands]`"),
        ("setup = [\"a\\nb\"]", "more than one line"),
        ("[stage.x]\ncpus = 0", "`stage.x.cpus` is 0"),
        ("[commands]\nsubmit = []\nalive = [\"a\"]\ncancel = [\"a\"]\nindex = \"1\"", "has no effect"),
    ] {
        let why = Site::parse(text).unwrap_err();
        assert!(why.contains(wanted), "{text}: {why}");
    }
    let two = Site::parse("workers = 0\ncpus = 0").unwrap_err();
    assert!(two.contains("workers") && two.contains("cpus"), "{two}");
}

#[test]
fn memory_reads_as_it_is_written() {
    for memory in [Memory(1), Memory(999), Memory(1000), Memory(1500), Memory(64_000)] {
        assert_eq!(Memory::try_from(memory.to_string()), Ok(memory));
    }
}
