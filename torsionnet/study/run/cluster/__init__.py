"""Studies on workers of dask.distributed, the processes of a machine, or those of a cluster that share a folder."""
