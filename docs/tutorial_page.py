"""Convert examples/tutorial.ipynb with its outputs to Markdown and image files."""

import base64
import json
import re

# image inside an HTML output
EMBEDDED = re.compile(r'<img src="data:image/png;base64,([^"]+)"[^>]*>')
FRAME = re.compile(r"<table [^>]*>")
STYLE = re.compile(r"<style.*?</style>\s*|\n\s*", re.S)


class Tutorial:
    """Pages and images of a notebook.

    Attributes:
        text: the page in Markdown.
        images: contents of the PNG files by name.
    """

    def __init__(self, notebook):
        self.images = {}
        self.text = "\n\n".join(part for cell in notebook["cells"] for part in self._cell(cell)) + "\n"

    @classmethod
    def read(cls, path):
        """Read a notebook from a file."""
        return cls(json.loads(path.read_text(encoding="utf-8")))

    def _cell(self, cell):
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            return [source]
        outputs = [part for output in cell["outputs"] for part in self._output(output)]
        return [f"```python\n{source}\n```", *outputs]

    def _output(self, output):
        data = output.get("data", {})
        if "text/html" in data:
            source = "".join(data["text/html"])
            table = STYLE.sub("", EMBEDDED.sub("", source))
            return [*map(self._image, EMBEDDED.findall(source)), FRAME.sub("<table>", table)]
        if "image/png" in data:
            return [self._image("".join(data["image/png"]))]
        text = "".join(output.get("text", data.get("text/plain", ""))).rstrip()
        return [f"```text\n{text}\n```"] if text else []

    def _image(self, encoded):
        name = f"figure_{len(self.images) + 1}.png"
        self.images[name] = base64.b64decode(encoded)
        return f"![Output of the program above]({name})"
