"""What a run leaves behind: folder, frames, tables, checkpoints, pictures, report."""
