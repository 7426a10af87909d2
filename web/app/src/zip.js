// A ZIP archive of files as they are (PKWARE's APPNOTE.TXT, 4.3), not compressed.

const TABLE = Uint32Array.from({ length: 256 }, (_, n) => {
  let value = n;
  for (let bit = 0; bit < 8; bit += 1) value = value & 1 ? (value >>> 1) ^ 0xedb88320 : value >>> 1;
  return value;
});

/** CRC-32 as in ZIP. */
export function crc32(bytes) {
  let value = 0xffffffff;
  for (const byte of bytes) value = TABLE[(value ^ byte) & 255] ^ (value >>> 8);
  return (value ^ 0xffffffff) >>> 0;
}

/** Numbers of two (`s`) or four (`l`) bytes, the lowest byte first. */
function numbers(...pairs) {
  const bytes = [];
  for (const [form, value] of pairs) for (let k = 0; k < (form === "s" ? 2 : 4); k += 1) bytes.push((value >>> (8 * k)) & 255);
  return Uint8Array.from(bytes);
}

/** 1 January 1980, the first day of ZIP: same files, same archive. */
const DAY = 0x21;
const UTF8 = 0x800;

/** The archive of `[name, bytes]` as a Blob. */
export function zip(files) {
  const parts = [];
  const directory = [];
  let offset = 0;
  for (const [name, bytes] of files) {
    const path = new TextEncoder().encode(name);
    const common = [["s", 20], ["s", UTF8], ["s", 0], ["s", 0], ["s", DAY], ["l", crc32(bytes)], ["l", bytes.length], ["l", bytes.length], ["s", path.length], ["s", 0]];
    const head = numbers(["l", 0x04034b50], ...common);
    directory.push(numbers(["l", 0x02014b50], ["s", 20], ...common, ["s", 0], ["s", 0], ["s", 0], ["l", 0], ["l", offset]), path);
    parts.push(head, path, bytes);
    offset += head.length + path.length + bytes.length;
  }
  const length = directory.reduce((sum, part) => sum + part.length, 0);
  const end = numbers(["l", 0x06054b50], ["s", 0], ["s", 0], ["s", files.length], ["s", files.length], ["l", length], ["l", offset], ["s", 0]);
  return new Blob([...parts, ...directory, end], { type: "application/zip" });
}
