# Holds JSON files against a JSON Schema of docs/schemas: type, required, properties, additionalProperties,
# items and enum; a schema with another word is an error.
#   perl tests/docs/schema.pl SCHEMA FILE...      exit 0 all hold, 1 not; each breach names its place
use strict;
use warnings;
use JSON::PP;

my $bad = 0;
sub breach { print "$_[0]: $_[1]\n"; $bad = 1 }

sub type_of {
    my ($value) = @_;
    return 'null' if !defined $value;
    return 'boolean' if JSON::PP::is_bool($value);
    return lc ref $value eq 'hash' ? 'object' : lc ref $value if ref $value;
    my $text = JSON::PP->new->allow_nonref->encode($value);
    return $text =~ /^"/ ? 'string' : $text =~ /^-?\d+$/ ? 'integer' : 'number';
}

sub hold {
    my ($at, $value, $schema) = @_;
    my $type = type_of($value);
    for my $word (keys %$schema) {
        die "$at: schema word $word\n"
            if $word !~ /^(\$schema|title|type|required|properties|additionalProperties|items|enum)$/;
    }
    my @types = ref $schema->{type} ? @{$schema->{type}} : $schema->{type} // ();
    if (@types && !grep { $_ eq $type || $_ eq 'number' && $type eq 'integer' } @types) {
        return breach($at, "$type, not " . join(' or ', @types));
    }
    return breach($at, "'$value' is none of " . join(' ', @{$schema->{enum}}))
        if $schema->{enum} && !grep { $_ eq $value } @{$schema->{enum}};
    if ($type eq 'object') {
        exists $value->{$_} || breach($at, "no $_") for @{$schema->{required} // []};
        for my $key (sort keys %$value) {
            my $of = ($schema->{properties} // {})->{$key};
            if ($of) { hold("$at.$key", $value->{$key}, $of) }
            elsif (exists $schema->{additionalProperties}) { breach($at, "$key is not in the schema") }
        }
    } elsif ($type eq 'array' && $schema->{items}) {
        hold("$at\[$_]", $value->[$_], $schema->{items}) for 0 .. $#$value;
    }
}

sub text_of { open my $in, '<', $_[0] or die "$_[0]: cannot read\n"; local $/; return decode_json(<$in>) }

my ($schema, @files) = @ARGV;
die "usage: schema.pl SCHEMA FILE...\n" if !@files;
hold($_, text_of($_), text_of($schema)) for @files;
exit $bad;
