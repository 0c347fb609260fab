"""Sub-legs, one file each, with one interface (`base.SubLeg`)."""
