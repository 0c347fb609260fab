"""From derivations to code, stage by stage; `pipeline` is the place to start reading."""
