"""How a study is calculated: in chunks of fixed size, by whoever has time, each kept as soon as it is done."""
