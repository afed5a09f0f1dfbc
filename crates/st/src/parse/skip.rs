//! The places where reading continues behind a mistake.

use super::Parser;
use crate::lex::{Token, Word};

/// Words that open an item at the top level of a file.
pub(super) const ITEMS: &[Word] = &[
    Word::Program,
    Word::FunctionBlock,
    Word::Function,
    Word::Type,
    Word::VarGlobal,
    Word::Configuration,
    Word::Class,
    Word::Interface,
    Word::Namespace,
    Word::EndProgram,
    Word::EndFunction,
    Word::EndFunctionBlock,
    Word::EndConfiguration,
    Word::EndType,
];

/// Words that begin or end a statement.
pub(super) const STATEMENTS: &[Word] = &[
    Word::If,
    Word::Case,
    Word::For,
    Word::While,
    Word::Repeat,
    Word::Exit,
    Word::Continue,
    Word::Return,
    Word::Elsif,
    Word::Else,
    Word::Until,
    Word::EndIf,
    Word::EndCase,
    Word::EndFor,
    Word::EndWhile,
    Word::EndRepeat,
];

/// Words that begin or end a section of variables.
pub(super) const SECTIONS: &[Word] = &[
    Word::Var,
    Word::VarInput,
    Word::VarOutput,
    Word::VarInOut,
    Word::VarTemp,
    Word::VarStat,
    Word::VarExternal,
    Word::VarGlobal,
    Word::VarInst,
    Word::VarAccess,
    Word::VarConfig,
    Word::EndVar,
    Word::EndStruct,
];

pub(super) fn is_item(word: Word) -> bool {
    ITEMS.contains(&word)
}

pub(super) fn is_statement(word: Word) -> bool {
    STATEMENTS.contains(&word)
}

pub(super) fn is_section(word: Word) -> bool {
    SECTIONS.contains(&word)
}

impl Parser<'_> {
    /// To the end of the statement or declaration: behind its `;`, or before a word that can only begin another
    /// one.
    pub(super) fn skip_to_semicolon(&mut self) {
        loop {
            match self.token() {
                Token::Semicolon => {
                    self.next();
                    return;
                }
                Token::End => return,
                Token::Word(word) if is_item(word) || is_statement(word) || is_section(word) => return,
                _ => self.pass(),
            }
        }
    }

    /// Behind this word.
    pub(super) fn skip_past(&mut self, end: Word) {
        while self.token() != Token::End && !self.take_word(end) {
            self.next();
        }
    }

    /// Behind the end of an ACTION, which is no keyword.
    pub(super) fn skip_action(&mut self) {
        self.next();
        self.note_refused();
        while !self.at_item() && !self.take_name("END_ACTION") {
            self.next();
        }
    }

    /// Before the next item at the top level of a file.
    pub(super) fn skip_to_item(&mut self) {
        while !self.at_item() {
            self.next();
        }
    }

    /// Whether an item at the top level of a file begins here, or the file ends.
    fn at_item(&self) -> bool {
        match self.token() {
            Token::Word(word) => is_item(word),
            token => token == Token::End,
        }
    }

    /// The same, or a section of variables.
    pub(super) fn at_declaration(&self) -> bool {
        self.at_item() || matches!(self.token(), Token::Word(word) if is_section(word))
    }
}
