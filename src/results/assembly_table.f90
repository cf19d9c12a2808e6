!> Card ASSEMBLY: all assemblies at the first instant. Each is printed as the LINK cards with which a run takes it.
module assembly_table
   use kinds, only: wp, label_length
   use plane_vectors, only: point_of, degree, wrap_angle
   use mechanism, only: mechanism_t, shown_links, instant, plane_origin, drive_words, driven_kinds
   use scales, only: characteristic_length, is_length
   use names, only: listed, subject_name
   use cards, only: ruler_card
   use assemblies, only: assemblies_t, assembly_t, assembly_block_t, max_assemblies
   use set_analysis, only: set_analysis_t
   use listing_layout, only: layout_t, write_folded
   use listing_tables, only: time_text
   use text_output, only: output_t, put
   use number_format, only: whole
   use phrases
   implicit none
   private
   public :: write_assemblies

   !> Characters of a number on a card, and on a * card; the first is a blank.
   integer, parameter :: card_number_width = 16, star_width = 24
   !> Digits after the point of a number on a card, with a sign and 0 before it.
   integer, parameter :: most_decimals = card_number_width - 4
   !> Digits that the largest number has: on cards of an estimate, and on cards with dimensions.
   integer, parameter :: estimate_digits = 10, drawing_digits = 13
   !> Angles have as many digits after the point as this one, in rad or degrees.
   real(wp), parameter :: largest_angle = 100.0_wp
   !> An angle, in rad, that rounding may add to half a turn.
   real(wp), parameter :: small_angle = max(1.0e-12_wp, 16.0_wp*epsilon(1.0_wp))
   character(*), parameter :: indent = '      '

contains

   !> Writes the lines of the assemblies of a set, mechanism after mechanism.
   subroutine write_assemblies(o, l, set)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(set_analysis_t), intent(in) :: set   !< with its assemblies
      integer :: c, k

      call put(o, '')
      call put(o, ' '//phrase(text_assemblies, set%now%polish)//'   T = '//time_text(l, instant(set%now, 0)) &
         //l%after_time)
      do c = 1, size(set%assemblies)
         associate (m => set%now%parts(c), a => set%assemblies(c))
            if (size(set%assemblies) > 1) call put(o, ' '//phrase(text_mechanism, m%polish)//' '//whole(c))
            do k = 1, size(a%blocks)
               call write_block(o, m, k, a%blocks(k))
            end do
            if (a%negative > 0) call put(o, ' --- '//phrase(text_negative, m%polish)//' '//whole(a%negative))
            if (a%are_more) call put(o, ' *** '//phrase(text_more_assemblies, m%polish)//' '//whole(max_assemblies))
            if (a%is_missed) call put(o, ' *** '//phrase(text_first_missed, m%polish))
            if (size(a%list) == 0) call put(o, '   '//phrase(text_none, m%polish))
            do k = 1, size(a%list)
               call write_assembly(o, m, k, a)
            end do
         end associate
      end do
   end subroutine write_assemblies

   !> Writes the line of a block, with its paths and its diagnostics. A block of hidden links alone has no names.
   subroutine write_block(o, m, k, one)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k               !< number of the block among those that are iterated
      type(assembly_block_t), intent(in) :: one   !< the block
      character(:), allocatable :: links, text
      integer, allocatable :: shown(:)

      shown = shown_links(m, one%links)
      links = phrase(merge(text_link, text_links, size(shown) == 1), m%polish)
      if (size(shown) > 0) links = links//' '//listed(m%links(shown)%name, m%polish)

      call write_folded(o, '   '//phrase(text_block, m%polish)//' '//whole(k)//': ', links, indent)
      text = phrase(text_unknowns, m%polish)//' '//whole(one%unknowns)//'   ' &
         //phrase(text_paths, m%polish)//' '//whole(one%paths)//' = ' &
         //whole(one%finite)//' '//phrase(text_finite, m%polish)//' + '//whole(one%infinite) &
         //' '//phrase(text_at_infinity, m%polish)//' + '//whole(one%failed)//' '//phrase(text_failed, m%polish)
      if (one%partial > 0) text = text//' + '//whole(one%partial)//' '//phrase(text_partial, m%polish)
      call write_folded(o, indent, text//'   '//phrase(text_real, m%polish)//' '//whole(one%real))
      if (one%is_large) call write_folded(o, ' *** ', links//': '//phrase(text_wide_block, m%polish))
      if (one%is_open) call write_folded(o, ' *** ', links//': '//phrase(text_contradiction, m%polish))
      if (one%moves) call write_folded(o, ' *** ', links//': '//phrase(text_curve_of_assemblies, m%polish))
      if (one%failed > 0) call write_folded(o, ' *** ', &
         links//': '//phrase(text_paths_failed, m%polish)//' '//whole(one%failed))
   end subroutine write_block

   !> Writes the lines of an assembly, with its cards.
   subroutine write_assembly(o, m, k, assemblies)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k               !< number of the assembly
      type(assemblies_t), intent(in) :: assemblies   !< of the mechanism
      character(1), parameter :: signs(-1:1) = ['-', '0', '+']
      character(:), allocatable :: text
      character(12) :: distance
      integer :: i

      associate (one => assemblies%list(k))
         write (distance, '(f12.4)') one%distance
         text = ' '//phrase(text_assembly, m%polish)//' '//whole(k)//'   '//phrase(text_distance, m%polish)//' = ' &
            //trim(adjustl(distance))
         if (size(assemblies%blocks) > 0) text = text//'   '//phrase(text_determinants, m%polish)//' '
         do i = 1, size(assemblies%blocks)
            ! 0: it is singular; a point: the block has more equations than unknowns.
            text = text//merge('.', signs(one%sign_of(assemblies%blocks(i)%block)), assemblies%blocks(i)%is_redundant)
         end do
         text = text//'   '//phrase(merge(text_assembly_proved, text_assembly_open, one%is_proved), m%polish)
         if (one%is_out) text = text//'   '//phrase(text_out_of_stroke, m%polish)
         if (k == assemblies%chosen) text = text//'   '//phrase(text_chosen, m%polish)
         call put(o, '')
         call put(o, text)
         call write_cards(o, m, one)
      end associate
   end subroutine write_assembly

   !> Writes the LINK cards of an assembly. If JOINT cards give the dimensions, LINK cards are a part of them: both are
   !> written as for a drawing of this assembly, with points that lengths have moved. A drive may take its value at t =
   !> 0 from the drawing. Its DRIVE card has the old value then, since the new drawing has another one.
   subroutine write_cards(o, m, one)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(assembly_t), intent(in) :: one    !< the assembly
      character(label_length) :: names(3)
      character(star_width) :: numbers(3)
      real(wp) :: position(3, size(m%links)), largest
      real(wp) :: x
      logical :: is_joint(size(m%pairs))
      integer :: i, k, digits

      do i = 1, size(m%links)
         position(:, i) = one%position(:, i) + [plane_origin(m), 0.0_wp]
         ! Angles are within half a turn of the estimate. Half a turn itself is forward, in spite of rounding.
         associate (estimate => m%links(i)%position(3))
            position(3, i) = estimate + wrap_angle(one%position(3, i) - estimate - small_angle) + small_angle
         end associate
      end do
      largest = max(characteristic_length(m), maxval(abs(position(:2, :))))
      ! Of all points only the two of a JOINT card have the same name.
      is_joint = m%points(m%pairs%point_i)%name == m%points(m%pairs%point_j)%name
      ! The digits after the point are those of a number of the characteristic length.
      digits = min(drawing_digits, estimate_digits + floor(log10(largest/characteristic_length(m))))
      if (any(is_joint)) digits = drawing_digits

      call put(o, ruler_card)
      do i = 1, size(m%links)
         if (m%links(i)%ground .or. m%links(i)%hidden) cycle
         names = ''
         names(1) = m%links(i)%name
         numbers(1) = number_text(position(1, i), largest, digits)
         numbers(2) = number_text(position(2, i), largest, digits)
         associate (angle => position(3, i)/merge(degree, 1.0_wp, m%degrees))
            numbers(3) = number_text(angle, max(largest_angle, abs(angle)), &
               min(drawing_digits, digits + floor(log10(max(1.0_wp, abs(angle)/largest_angle)))))
         end associate
         if (m%links(i)%from > 0) names(2:) = m%points([m%links(i)%from, m%links(i)%to])%name
         where (m%links(i)%along) numbers = ''
         call write_card(o, 'LINK    ', names, numbers)
      end do

      do i = 1, size(m%pairs)
         if (.not. is_joint(i)) cycle
         associate (p => m%points(m%pairs(i)%point_i), q => m%points(m%pairs(i)%point_j))
            names = [m%pairs(i)%name, m%links(p%link)%name, m%links(q%link)%name]
            associate (place => point_of(position(:, p%link), p%offset))
               numbers(1) = number_text(place(1), largest, digits)
               numbers(2) = number_text(place(2), largest, digits)
            end associate
            call write_card(o, 'JOINT   ', names, numbers(:2))
         end associate
      end do

      do i = 1, size(m%points)
         associate (p => m%points(i))
            if (p%drawn .or. .not. (p%moves .and. any(is_joint))) cycle
            names = [p%name, m%links(p%link)%name, '        ']
            do k = 1, 2
               numbers(k) = number_text(p%offset(k), largest, digits)
            end do
            call write_card(o, 'POINT   ', names, numbers(:2))
         end associate
      end do

      do i = 1, size(m%drives)
         associate (drive => m%drives(i))
            if (.not. drive%drawn) cycle
            names = [drive_words(drive%kind), subject_name(m, driven_kinds(drive%kind), drive%subject), '        ']
            if (drive%second > 0) names(3) = m%links(drive%second)%name
            do k = 1, size(numbers)
               x = drive%polynomial(k)
               if (m%degrees .and. .not. is_length(drive)) x = x/degree
               numbers(k) = number_text(x, merge(abs(x), 1.0_wp, abs(x) > 0.0_wp), drawing_digits)
            end do
            call write_card(o, 'DRIVE   ', names, numbers)
         end associate
      end do
   end subroutine write_cards

   !> Writes a card with its name, labels and numbers. If one number leaves no room for a blank, the numbers are on a
   !> second card, a * card.
   subroutine write_card(o, name, labels, numbers)
      type(output_t), intent(inout) :: o
      character(8), intent(in) :: name       !< of the card: LINK, ...
      character(label_length), intent(in) :: labels(3)   !< blank: none
      character(star_width), intent(in) :: numbers(:)   !< (1 to 3) as `number_text` gives them; blank: none
      character(:), allocatable :: text, stars
      integer :: k

      text = name//labels(1)//labels(2)//labels(3)
      if (all(len_trim(adjustl(numbers)) < card_number_width)) then
         do k = 1, size(numbers)
            text = text//numbers(k)(star_width - card_number_width + 1:)
         end do
         call put(o, trim(text))
      else
         stars = '*       '
         do k = 1, size(numbers)
            stars = stars//numbers(k)
         end do
         call put(o, trim(text))
         call put(o, stars)
      end if
   end subroutine write_card

   !> Gives a number in the columns of a * card, at the right, without digits of rounding.
   function number_text(value, largest, digits) result(text)
      real(wp), intent(in) :: value          !< in the unit of the card
      real(wp), intent(in) :: largest        !< the largest number of this kind on the cards, above 0
      integer, intent(in) :: digits          !< digits that the largest number has
      character(star_width) :: text
      character(16) :: form
      real(wp) :: unit, rounded
      integer :: power, decimals

      power = floor(log10(largest))
      decimals = digits - 1 - power
      unit = 10.0_wp**(-decimals)
      rounded = anint(value/unit)
      if (abs(rounded) <= 0.0_wp) rounded = 0.0_wp
      if (power < digits .and. decimals <= most_decimals) then
         write (form, '(a, i0, a)') '(f24.', decimals, ')'
      else
         ! A number with 13 digits has a * card then; an estimate may lose some digits.
         write (form, '(a, i0, a)') '(es24.', merge(drawing_digits - 1, 8, digits >= drawing_digits), ')'
      end if
      write (text, form) rounded*unit
   end function number_text
end module assembly_table
