# SPDX-License-Identifier: MIT
"""Records of tandem as pandas frames: read, compared and plotted.

    import tandem
    records = tandem.read("run.jsonl")
    records.cells[["algorithm", "set_k", "ms", "ms_low", "ms_high"]]
    tandem.compare("old.jsonl", "new.jsonl")
    tandem.plot_cells(records)
"""
from .comparison import Comparison, compare
from .lines import RecordError
from .plots import plot_cells, plot_errors, plot_frames, plot_stages, plot_sweep
from .records import Records, read

__all__ = ["Comparison", "RecordError", "Records", "compare", "plot_cells", "plot_errors", "plot_frames", "plot_stages", "plot_sweep", "read"]
__version__ = "0.1.0"
