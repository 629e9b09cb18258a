-- xy_stage_x_shaper_avalon: component declaration and constants for a design in VHDL
-- Written by posicast 0.1.0; do not edit.

library ieee;
use ieee.std_logic_1164.all;

package xy_stage_x_shaper_avalon_pkg is

    component xy_stage_x_shaper_avalon is
        port (
            clk            : in  std_logic;
            rst            : in  std_logic;
            avs_address    : in  std_logic_vector(7 downto 0);
            avs_read       : in  std_logic;
            avs_write      : in  std_logic;
            avs_byteenable : in  std_logic_vector(3 downto 0);
            avs_writedata  : in  std_logic_vector(31 downto 0);
            strobe         : in  std_logic;
            start          : in  std_logic;
            x_0            : in  std_logic_vector(31 downto 0);  -- signed
            x_1            : in  std_logic_vector(31 downto 0);  -- signed
            x_2            : in  std_logic_vector(31 downto 0);  -- signed
            avs_readdata   : out std_logic_vector(31 downto 0);
            irq            : out std_logic;
            y_0            : out std_logic_vector(31 downto 0);  -- signed
            y_1            : out std_logic_vector(31 downto 0);  -- signed
            y_2            : out std_logic_vector(31 downto 0);  -- signed
            valid          : out std_logic
        );
    end component;

    -- Word addresses of the registers.
    constant magic_word                : natural := 16#0#;
    constant version_word              : natural := 16#1#;
    constant word_bits_word            : natural := 16#2#;
    constant channels_word             : natural := 16#3#;
    constant ring_samples_word         : natural := 16#4#;
    constant most_taps_word            : natural := 16#5#;
    constant machine_taps_word         : natural := 16#6#;
    constant coefficient_fraction_word : natural := 16#7#;
    constant modulo_word               : natural := 16#8#;
    constant control_word              : natural := 16#10#;
    constant status_word               : natural := 16#11#;
    constant flags_word                : natural := 16#12#;
    constant interrupt_state_word      : natural := 16#14#;
    constant interrupt_enable_word     : natural := 16#15#;
    constant interrupt_test_word       : natural := 16#16#;
    constant x_0_word                  : natural := 16#18#;
    constant x_1_word                  : natural := 16#19#;
    constant x_2_word                  : natural := 16#1a#;
    constant strobe_word               : natural := 16#1c#;
    constant start_word                : natural := 16#1d#;
    constant y_0_word                  : natural := 16#20#;
    constant y_1_word                  : natural := 16#21#;
    constant y_2_word                  : natural := 16#22#;
    constant tap_address_word          : natural := 16#28#;
    constant tap_word                  : natural := 16#29#;
    constant swap_word                 : natural := 16#2a#;
    constant tap_read_word             : natural := 16#2b#;
    constant tap_loaded_word           : natural := 16#2c#;

end package;
