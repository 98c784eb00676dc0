"""`python -m harness.identify.record`: write the JSON Schema of diagnosis.json anew."""

from harness.identify.record.file import SCHEMA_FILE, schema_text

if __name__ == "__main__":
    SCHEMA_FILE.write_text(schema_text(), encoding="utf-8")
