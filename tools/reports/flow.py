"""The control flow of a linked program, read off its machine code: blocks, calls and loops.

A function is what is reached from the target of a call, without the calls; code that two functions
end with belongs to both.
"""

import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from reports.targets import ToolError, run

CONDITIONS = "eq|ne|cs|hs|cc|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le"
JUMP, BRANCH, CALL, RETURN, INDIRECT = "jump", "branch", "call", "return", "indirect call"
MAYBE, TAIL, TABLE = "return, or not", "indirect call and return", "jump by a table"
# What an instruction does to the flow.  A suffix .n or .w is gone; "ble" is a branch, not a call.
KINDS = [  # name and operands
    (re.compile(r"(?:le|letp)\b.*<|(?:wls|wlstp\.\d+)\b.*<"), BRANCH),
    (re.compile(rf"b(?:{CONDITIONS})\s.*<|cbn?z\s.*<"), BRANCH),
    (re.compile(r"b\s.*<|j\s.*<"), JUMP),
    (re.compile(r"blx?\s.*<|jal\s.*<|jalr\s.*<"), CALL),
    (re.compile(r"blx\s+\w+|jalr\s"), INDIRECT),
    (re.compile(r"bx\s+lr|jr t0|(?:pop|ldmia\S*)\s.*\bpc\}|ldr\S*\s+pc, \[sp|ret\b"), RETURN),
    (re.compile(rf"(?:bx|pop|ldmia|ldr)(?:{CONDITIONS})\S*\s.*(?:\blr$|\bpc\}}|^pc,)"), MAYBE),
    (re.compile(r"bx\s+\w+"), TAIL),
    (re.compile(r"b(?:eqz|nez|lez|gez|ltz|gtz|eq|ne|lt|ge|ltu|geu|gt|le|gtu|leu)\s.*<"), BRANCH),
    (re.compile(r"mov\S*\s+pc, r\d|jr\s"), TABLE),
    (re.compile(r"tb[bh]\b|\S+\s+pc, "), "unknown"),
]  # fmt: skip


@dataclass
class Instruction:
    address: int
    text: str  # name and operands
    line: tuple[str, int] | None  # of the source

    @cached_property
    def kind(self) -> str:
        text = re.sub(r"^(\w+)\.[nw]\b", r"\1", self.text)
        return next((kind for pattern, kind in KINDS if pattern.match(text)), "")

    @cached_property
    def target(self) -> int:
        """Of a jump, branch or call."""
        return int(re.search(r"([0-9a-f]+) <[^>]*>", self.text)[1], 16)


@dataclass
class Block:
    """Instructions that are run one after the other."""

    instructions: list[Instruction]
    after: list[int] = field(default_factory=list)  # addresses of the blocks that may follow
    calls: list[int | None] = field(default_factory=list)  # targets; None: through a pointer

    @property
    def start(self) -> int:
        return self.instructions[0].address


@dataclass
class Loop:
    head: int
    body: set[int]  # blocks
    back: list[int]  # the blocks that jump to the head
    exits: list[int]  # the blocks that leave it


@dataclass
class Function:
    entry: int
    blocks: dict[int, Block]

    @cached_property
    def before(self) -> dict[int, list[int]]:
        found: dict[int, list[int]] = {address: [] for address in self.blocks}
        for address, block in self.blocks.items():
            for to in block.after:
                found[to].append(address)
        return found

    @cached_property
    def dominators(self) -> dict[int, set[int]]:
        """Of each block: those that are run before it, whatever the way."""
        everything = set(self.blocks)
        found = {address: everything for address in self.blocks} | {self.entry: {self.entry}}
        changed = True
        while changed:
            changed = False
            for address in self.blocks:
                if address == self.entry:
                    continue
                new = set.intersection(*(found[b] for b in self.before[address])) | {address}
                if new != found[address]:
                    found[address], changed = new, True
        return found

    def loops(self) -> list[Loop]:
        """The natural ones, by their heads.  ToolError where there are others."""
        heads: dict[int, list[int]] = {}
        for address, block in self.blocks.items():
            for to in block.after:
                if to in self.dominators[address]:
                    heads.setdefault(to, []).append(address)
        self._require_no_other_circles(heads)
        return [self._loop(head, back) for head, back in sorted(heads.items())]

    def _loop(self, head: int, back: list[int]) -> Loop:
        body, todo = {head}, list(back)
        while todo:
            if (address := todo.pop()) not in body:
                body.add(address)
                todo += self.before[address]
        exits = [a for a in sorted(body) if not set(self.blocks[a].after) <= body]
        return Loop(head, body, back, exits)

    def _require_no_other_circles(self, heads: dict[int, list[int]]) -> None:
        """Without the edges back to heads nothing may go in circles."""
        left = {a: {b for b in self.before[a] if b not in heads.get(a, [])} for a in self.blocks}
        while free := [a for a, before in left.items() if not before]:
            for address in free:
                del left[address]
                for before in left.values():
                    before.discard(address)
        if left:
            raise ToolError(f"a loop at {min(left):x} that is entered in the middle")


class Program:
    """A linked program."""

    def __init__(self, image: Path, cross: str) -> None:
        self.symbols: dict[str, int] = {}
        self.code: dict[int, Instruction] = {}
        for name, instruction in read_code(run(f"{cross}objdump", "-d", "-l", image)):
            if instruction is None:
                continue
            self.symbols.setdefault(name, instruction.address)
            self.code[instruction.address] = instruction
        for line in run(f"{cross}nm", image).splitlines():
            address, kind, name = line.rsplit(maxsplit=2) if line[0] != " " else ("0", "U", "")
            if kind in "tTW":
                self.symbols[name] = int(address, 16) & ~1
        self.words = read_words(run(f"{cross}objdump", "-s", "-j", ".text", "-j", ".rodata", image))
        self.functions = sorted(self.symbols.values())
        addresses = sorted(self.code)
        for two, one, at in zip(addresses, addresses[1:], addresses[2:], strict=False):
            to = self.code[at].text.partition(" ")[2]
            if f"pop {{{to}}}" in (self.code[two].text, self.code[one].text):
                self.code[at].kind = RETURN  # to what was pushed as lr
        self.next = dict(zip(addresses, addresses[1:], strict=False))

    def name(self, address: int) -> str:
        return next((name for name, at in self.symbols.items() if at == address), f"{address:x}")

    def is_tail_call(self, instruction: Instruction) -> bool:
        """A jump to where a register says, in a function without a table."""
        return instruction.kind == TABLE and not self.in_tables(instruction.address)

    def symbol(self, address: int) -> str:
        """That of a place in the code."""
        return self.name(self.entry_of(address))

    def entry_of(self, address: int) -> int:
        """Of the function that a place is in, also where another one jumps into it at its end."""
        return self.functions[bisect_right(self.functions, address) - 1]

    def in_tables(self, address: int) -> list[int]:
        """The places in the function of an address that constant data name: a jump by a table goes
        to one of these."""
        at = bisect_right(self.functions, address)
        end = self.functions[at] if at < len(self.functions) else address + 4
        return [n for n in self.code if self.functions[at - 1] < n < end and n in self.words]

    def function(self, entry: int) -> Function:
        """What is reached from there without calls."""
        reached, todo, starts = set(), [entry], {entry}
        while todo:
            address = todo.pop()
            if address in reached:
                continue
            if address not in self.code:
                raise ToolError(f"no code at {address:x}")
            reached.add(address)
            after = self.after(self.code[address])
            if self.code[address].kind not in ("", CALL, INDIRECT):
                starts.update(after)
            todo += after
        return Function(entry, dict(self.blocks(reached, starts)))

    def after(self, instruction: Instruction) -> list[int]:
        """Where the flow goes on; calls come back."""
        kind, following = instruction.kind, self.next.get(instruction.address, -1)
        if kind == "unknown":
            raise ToolError(f"{instruction.address:x}: where does {instruction.text} go?")
        if kind in (RETURN, TAIL):
            return []
        if kind == TABLE:
            return self.in_tables(instruction.address)
        if kind == JUMP:
            return [instruction.target]
        return [following, instruction.target] if kind == BRANCH else [following]

    def blocks(self, reached: set[int], starts: set[int]) -> Iterator[tuple[int, Block]]:
        block: Block | None = None
        for address in sorted(reached):
            instruction = self.code[address]
            if block is None or address in starts:
                block = Block([])
                yield address, block
            block.instructions.append(instruction)
            if instruction.kind == CALL:
                block.calls.append(instruction.target)
            elif instruction.kind in (INDIRECT, TAIL) or self.is_tail_call(instruction):
                block.calls.append(None)
            after = self.after(instruction)
            if after != [self.next.get(address)] or after[0] in starts:
                block.after = list(dict.fromkeys(after))
                block = None


def read_code(text: str) -> Iterator[tuple[str, Instruction | None]]:
    """The instructions of `objdump -d -l`, with the symbol before each."""
    name, line = "", None
    for row in text.splitlines():
        if start := re.fullmatch(r"[0-9a-f]+ <([^>]+)>:", row):
            name, line = start[1], None
        elif place := re.fullmatch(r"(/\S+):(\d+)(?: \(discriminator \d+\))?", row):
            line = place[1], int(place[2])
        elif cells := re.fullmatch(r"\s*([0-9a-f]+):\t[0-9a-f ]+\t(.*)", row):
            words = cells[2].replace("\t", " ").partition(" @ ")[0].partition(" ; ")[0].strip()
            if not words.startswith("."):
                yield name, Instruction(int(cells[1], 16), words, line)


def read_words(text: str) -> set[int]:
    """The words of `objdump -s`, little-endian, without the bit of Thumb."""
    found = set()
    for row in text.splitlines():
        if cells := re.match(r" [0-9a-f]+ ((?:[0-9a-f]{8} ?)+)", row):
            for word in re.findall(r"[0-9a-f]{8}", cells[1]):
                found.add(int.from_bytes(bytes.fromhex(word), "little") & ~1)
    return found


def reachable(program: Program, entry: int, pointers: dict[int, int]) -> dict[int, Function]:
    """The functions that are called from an entry, by their own.

    pointers  what a function calls through a pointer, by its entry
    """
    found: dict[int, Function] = {}
    todo: list[int | None] = [entry]
    while todo:
        address = todo.pop()
        if address is None or address in found:
            continue
        found[address] = program.function(address)
        for at, block in found[address].blocks.items():
            there = pointers.get(program.entry_of(at))
            todo += [there if call is None else call for call in block.calls]
    return found
