local head = coif.head { file = "../../Cargo.toml" }
