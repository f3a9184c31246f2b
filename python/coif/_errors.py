"""The exceptions that Coif raises. Each carries the sentence that the C++ library wrote."""


class Error(Exception):
    """What Coif refuses to do, in one sentence: bad files, bad geometry, operations that would break the hair mesh.

    ``str(error)`` is the whole sentence, with the file and the place in front where there are any.

    Attributes:
        code: the kind of fault, a coif.ErrorCode.
        message: the sentence without file and place.
        file: the file at fault, or ''.
        place: 'line 12', 'byte 128', 'face 7', or ''.
    """

    def __init__(self, text: str = "", code=None, message: str = "", file: str = "", place: str = "") -> None:
        super().__init__(text)
        self.text = text
        self.code = code
        self.message = message or text
        self.file = file
        self.place = place

    def __str__(self) -> str:
        return self.text

    def __reduce__(self):
        return type(self), (self.text, self.code, self.message, self.file, self.place)


class ArgumentError(Error, ValueError):
    """An Error about an argument outside its stated range (code INVALID_ARGUMENT). Also a ValueError."""


class MissingFileError(Error, FileNotFoundError):
    """An Error about a file that does not exist (code NOT_FOUND). Also a FileNotFoundError."""
