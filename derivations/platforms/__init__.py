"""Platform arrangements, one file each (Fig. 2.1)."""
