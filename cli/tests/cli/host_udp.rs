//! `posicast host udp://…`, with the server of the generated driver at an address of this computer. In place of a UIO device, a file has the
//! registers.

use super::support::{example, generate, json, posicast, scratch};
use posicast_blocks::registers::Access;
use posicast_machine::hardware::Hardware;
use posicast_machine::machine_file;
use posicast_machine::plan::design_machine;
use std::net::UdpSocket;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

/// Word of MACHINE_CRC.
const CRC_WORD: usize = 6;

fn machine() -> String {
    std::fs::read_to_string(example("xy-stage.toml")).unwrap() + "[link]\nbaud = 3_000_000\n"
}

/// The constants of the stage, as they are in its memory.
fn registers(text: &str) -> Vec<u32> {
    let machine = machine_file::parse("machine.toml", text).unwrap();
    let design = design_machine(&machine).unwrap();
    let hardware = Hardware::of(&machine, &design).unwrap();
    let map = hardware.stage().unwrap().unwrap().component.map();
    let mut words = vec![0; map.words() as usize];
    for register in map.registers().iter().filter(|of| of.access == Access::Constant) {
        words[register.offset as usize] = register.reset();
    }
    words
}

fn write(path: &Path, words: &[u32]) {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_ne_bytes()).collect();
    std::fs::write(path, bytes).unwrap();
}

/// Generates the package, and builds the server.
fn built(folder: &Path, machine: &Path) -> PathBuf {
    let package = folder.join("package");
    generate(machine, &package);
    let linux = package.join("driver/linux");
    let made = Command::new("make").arg("-C").arg(&linux).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    linux.join("posicast_serve")
}

fn words(output: &Output) -> (Option<i32>, String) {
    let said = [&output.stdout[..], &output.stderr].concat();
    (output.status.code(), String::from_utf8(said).unwrap())
}

/// A server that ends with the test.
struct Served {
    child: Child,
    url: String,
}

impl Served {
    fn new(server: &Path, device: &Path) -> Self {
        // A port that was free a moment ago.
        let free = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let child = Command::new(server)
            .arg(device)
            .args(["127.0.0.1", &free.to_string()])
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let url = format!("udp://127.0.0.1:{free}");
        Self { child, url }
    }

    fn host(&self, machine: &Path, more: &[&str]) -> (Option<i32>, String) {
        for _ in 0..100 {
            let mut host = posicast();
            host.args(["host", &self.url, "status", "--machine"])
                .arg(machine)
                .args(more);
            let (code, said) = words(&host.output().unwrap());
            // The server has not begun yet.
            if !said.contains("refused: does posicast_serve run there") {
                return (code, said);
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        panic!("there is no server at {}", self.url);
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn cli_host_operates_a_stage_over_the_network() {
    let text = machine();
    let (folder, file) = scratch(&text);
    let server = built(folder.path(), &file);
    let device = folder.path().join("uio");
    let constants = registers(&text);
    write(&device, &constants);
    let served = Served::new(&server, &device);
    let (code, said) = served.host(&file, &["--json"]);
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(json(said.as_bytes())["axes"][1]["state"], "OFF");

    // Every command says which machine it wants.
    let other = folder.path().join("other.toml");
    std::fs::write(&other, format!("{text}# after the tuning\n")).unwrap();
    let (code, said) = served.host(&other, &[]);
    let wanted = registers(&format!("{text}# after the tuning\n"))[CRC_WORD];
    let [found, wanted] = [constants[CRC_WORD], wanted].map(|crc| format!("{crc:08x}"));
    assert!(
        code == Some(2) && said.contains(&found) && said.contains(&wanted),
        "{said}"
    );
    let (code, said) = served.host(&file, &["--baud", "115200"]);
    assert!(code == Some(2) && said.contains("is not a serial line"), "{said}");

    let mut nobody = posicast();
    nobody
        .args(["host", "udp://127.0.0.1:1", "status", "--machine"])
        .arg(&file);
    let (code, said) = words(&nobody.output().unwrap());
    assert!(
        code == Some(3) && said.contains("does posicast_serve run there"),
        "{said}"
    );
}

#[test]
fn cli_the_server_refuses_a_stage_of_another_machine_file() {
    let text = machine();
    let (folder, file) = scratch(&text);
    let server = built(folder.path(), &file);
    let device = folder.path().join("uio");
    let mut constants = registers(&text);
    let wanted = constants[CRC_WORD];
    constants[CRC_WORD] ^= 1;
    write(&device, &constants);
    let run = |device: &Path, address: &str| {
        let output = Command::new(&server).arg(device).args([address, "0"]).output();
        words(&output.unwrap())
    };
    let (code, said) = run(&device, "127.0.0.1");
    let both = format!("MACHINE_CRC of the stage is {:#010x}, and {wanted:#010x}", wanted ^ 1);
    assert!(code == Some(3) && said.contains(&both), "{said}");
    let (code, said) = run(&folder.path().join("none"), "127.0.0.1");
    assert!(code == Some(3) && said.contains("No such file"), "{said}");
    constants[CRC_WORD] = wanted;
    write(&device, &constants);
    let (code, said) = run(&device, "localhost");
    assert!(
        code == Some(3) && said.contains("localhost: Invalid argument"),
        "{said}"
    );
    let (code, said) = words(&Command::new(&server).output().unwrap());
    assert!(
        code == Some(2) && said.starts_with("usage: posicast_serve DEVICE ADDRESS PORT"),
        "{said}"
    );
}
