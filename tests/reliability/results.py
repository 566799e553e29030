"""What a command made, in a form that two runs of it share: clocks are left out. For faults and stops."""
import hashlib, json, re
from pathlib import Path


def normal(path: Path) -> bytes:
    data = path.read_bytes()
    if path.suffix == '.html':
        data = re.sub(rb'on \d{4}-\d\d-\d\d \d\d:\d\d', b'', data)
        data = re.sub(rb'\d+(\.\d+)? s\b', b'', data)
    if path.suffix == '.pdf':
        data = re.sub(rb'/CreationDate \([^)]*\)', b'', data)
    if path.name == 'design-report.json' and data.startswith(b'{'):
        report = json.loads(data)
        report.pop('seconds', None)
        for step in report.get('history', []):
            step.pop('seconds', None)
        data = json.dumps(report).encode()
    if path.parent.name == 'made' and path.suffix == '.json':
        # A stage's record holds the hashes of what it rests on and made; those of the files above have clocks in them.
        data = re.sub(rb'("[^"]*(?:report\.html|carve-check\.html|design-report\.json)": ")[0-9a-f]{64}"', rb'\1"', data)
    return data


def hidden(file: Path) -> bool:
    """A file, relative to its project, that a person does not see."""
    return any(part.startswith('.') for part in file.parts)


def tree(folder: Path, kept=lambda file: True):
    """Hashes of what the files hold of which `kept` (relative to the folder) is true."""
    files = (p.relative_to(folder) for p in sorted(folder.rglob('*')) if p.is_file())
    return {str(file): hashlib.sha256(normal(folder / file)).hexdigest() for file in files if kept(file)}


def differences(want, have):
    return [f'{f} {"is missing" if f not in have else "differs"}' for f in want if have.get(f) != want[f]] + \
           [f'{f} is left over' for f in have if f not in want]
