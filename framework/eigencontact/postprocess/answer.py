"""Result of an evaluation of stored results: dataset, summary and files."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from typing import Self

    import xarray

__all__ = ["Answer"]


@dataclass(frozen=True, eq=False)
class Answer:
    """Result of an evaluation.

    Attributes
    ----------
    dataset : xarray.Dataset
        Fields with coordinates and units.
    summary : dict
        Numbers and words, as JSON stores them.
    files : dict
        Files that were stored, and what they show.
    """

    dataset: xarray.Dataset
    summary: dict[str, Any]
    files: dict[Path, str] = field(default_factory=dict)

    def lines(self) -> list[str]:
        """Words for the terminal."""
        raise NotImplementedError

    def __repr__(self) -> str:
        return f"{type(self).__name__}({'; '.join(self.lines())})"

    def stored(
        self, folder: str | Path, stem: str, subject: str, contents: tuple[str, str], draw: Callable[[Path], str]
    ) -> Self:
        """Store ``stem.nc``, ``.json`` and ``.png``; return the result with its files.

        Parameters
        ----------
        folder : str or Path
        stem, subject : str
            Name of the files, and what an error calls them.
        contents : (str, str)
            What the dataset and the summary hold.
        draw : callable
            Draws the picture and returns what it shows; nothing where there is none.

        Raises
        ------
        ResultsError
            A file of another origin has such a name; a folder that cannot be written.
        """
        from eigencontact.results.atomic import replacing, writable_folder
        from eigencontact.results.ownership import refuse_foreign_file

        paths = {ending: Path(folder) / f"{stem}.{ending}" for ending in ("nc", "json", "png")}
        for path in paths.values():
            refuse_foreign_file(path)
        writable_folder(Path(folder))
        data = BytesIO()
        self.dataset.to_netcdf(data, engine="h5netcdf")
        text = json.dumps(self.summary, indent=2, default=str) + "\n"
        for ending, content in (("nc", data.getvalue()), ("json", text.encode())):
            with replacing(paths[ending], subject) as sink:
                sink.write(content)
        files = dict(zip((paths["nc"], paths["json"]), contents, strict=True))
        sentence = draw(paths["png"])
        return replace(self, files=files | ({paths["png"]: sentence} if sentence else {}))
