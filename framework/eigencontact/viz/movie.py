"""Films from figures: GIF by Pillow, a dependency of matplotlib, and MP4 by the program ffmpeg."""

from __future__ import annotations

import io
import shutil
import subprocess
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.spatial import KDTree

from eigencontact import __version__
from eigencontact.errors import EigencontactError, ResultsError, SceneError, shown
from eigencontact.results.atomic import replacing

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from matplotlib.figure import Figure
    from numpy.typing import NDArray
    from PIL.Image import Image

__all__ = ["refuse_animation", "write_movie"]

#: Length of a film [s] whose frames stay within the next two limits.
LENGTH = 9.0
#: Shortest time of a frame [ms].
SHORTEST = 80
#: Longest time of a frame [ms].
LONGEST = 500
#: The last frame stays [ms].
LAST = 1500
#: Frames whose colours make the palette, which all frames of a GIF share so that colours do not flicker.
SAMPLES = 6
#: Colours closer than this (of 255) share an entry of the palette: a map and the edges of letters then fit into 256.
ALIKE = 5


def refuse_animation(file_format: Literal[True, "gif", "mp4"], steps: int, *, shows: bool) -> None:
    """Refuse ``output.animation`` of a scene if it cannot be written after a run of `steps` load steps.

    `shows` says whether there is contact or a plane of stress. The `SceneError` says what to write instead.
    """
    if steps < 2 or not shows:
        raise SceneError(
            "output.animation must be false where there are not several load steps with contact or a plane of stress "
            f"(got {shown(file_format)} with a number of load steps of {steps}); give a step increments"
        )
    if file_format == "mp4":
        _ffmpeg("output.animation", SceneError)


def _ffmpeg(setting: str, error: type[EigencontactError]) -> str:
    """Path of ffmpeg; refuses MP4 if it is missing."""
    program = shutil.which("ffmpeg")
    if program is None:
        raise error(
            f"{setting} must be 'gif' where the program ffmpeg is not installed (got 'mp4', and no ffmpeg on the "
            "search path); install ffmpeg, or ask for a GIF"
        )
    return program


def write_movie(figures: Iterable[Figure], path: Path) -> None:
    """Write frames of one size as ``.gif`` or ``.mp4``, by the extension; each is drawn before the next is requested.

    The file appears complete or not at all, and names this package. `ResultsError` when it cannot be stored, or ffmpeg
    is missing or fails.
    """
    if path.suffix == ".mp4":
        _ffmpeg("the animation", ResultsError)
    images = [_image(figure) for figure in figures]
    pause = int(np.clip(1000 * LENGTH / len(images), SHORTEST, LONGEST)) // 10 * 10
    with replacing(path, f"animation {path.name}") as sink:
        sink.write(_mp4(images, pause) if path.suffix == ".mp4" else _gif(images, pause))


def _image(figure: Figure) -> Image:
    from PIL import Image

    figure.canvas.draw()
    return Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3].copy())  # type: ignore[attr-defined]


def _gif(images: list[Image], pause: int) -> bytes:
    from PIL import Image

    palette = _palette(images[:: max(1, len(images) // SAMPLES)])
    palette_frames = []
    for image in images:
        colours, place = _colours(image)
        nearest = KDTree(palette).query(colours)[1].astype(np.uint8)
        frame = Image.fromarray(nearest[place].reshape(image.height, image.width))
        frame.putpalette(palette.tobytes())
        palette_frames.append(frame)
    file = io.BytesIO()
    palette_frames[0].save(
        file,
        format="GIF",
        save_all=True,
        append_images=palette_frames[1:],
        duration=[pause] * (len(palette_frames) - 1) + [LAST],
        loop=0,
        comment=f"eigencontact {__version__}".encode(),
    )
    return file.getvalue()


def _colours(image: Image) -> tuple[NDArray[np.uint8], NDArray[np.intp]]:
    """Colours (n, 3) of an image, and for each pixel the number of its colour."""
    packed = np.zeros((image.height * image.width, 4), dtype=np.uint8)
    packed[:, :3] = np.asarray(image).reshape(-1, 3)
    colours, place = np.unique(packed.view(np.uint32).ravel(), return_inverse=True)
    return colours.view(np.uint8).reshape(-1, 4)[:, :3], place


def _palette(images: list[Image]) -> NDArray[np.uint8]:
    """At most 256 colours (n, 3): the most frequent ones, with similar colours merged."""
    from PIL import Image

    colours, place = _colours(Image.fromarray(np.concatenate([np.asarray(image) for image in images])))
    candidates = colours[np.argsort(-np.bincount(place), kind="stable")].astype(int)
    palette: list[NDArray[np.int_]] = []
    while len(candidates) and len(palette) < 256:
        palette.append(candidates[0])
        candidates = candidates[np.square(candidates - candidates[0]).sum(axis=1) > ALIKE**2]
    return np.array(palette, dtype=np.uint8)


def _mp4(images: list[Image], pause: int) -> bytes:
    """Write an MP4 (H.264) of frames, with the last one held."""
    width, height = images[0].size
    rate = f"1000/{pause}"
    held_frames = [*images, *[images[-1]] * (LAST // pause)]
    reads = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", rate, "-i", "-"]
    writes = ["-c:v", "libx264", "-pix_fmt", "yuv420p", "-metadata", f"comment=eigencontact {__version__}"]
    # What goes to a pipe cannot be sought in: a fragmented file is written from front to end.
    ends = ["-movflags", "frag_keyframe+empty_moov", "-f", "mp4", "-"]
    process = subprocess.run(
        [_ffmpeg("the animation", ResultsError), "-v", "error", *reads, *writes, *ends],
        input=b"".join(image.tobytes() for image in held_frames),
        capture_output=True,
        check=False,
    )
    if process.returncode:
        problem = " ".join(process.stderr.decode(errors="replace").split())
        raise ResultsError(f"ffmpeg must write the animation (got: {problem}); ask for a GIF instead")
    return process.stdout
