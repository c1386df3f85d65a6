"""Studies: a list of cases solved or run by several variants at several tolerances, time steps or numbers of subdomains.

A study file (TOML, doc/guide/studies.md) becomes a `Study` (study_file, description, blocks; model); its jobs (jobs) are run through the program, each
leaving one file (runner); results become errors (measures), profiles (profiles), figures (drawings), and one page (page).
"""
